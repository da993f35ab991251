#!/usr/bin/env python3
"""Renders a glTF scene with Mitsuba 3 and prints the seconds of sampling.

mitsuba_scene.py VARIANT SCENE.gltf SPP THREADS EVENTS SEED SCALE [OUTPUT.pfm]
Lambert materials (KHR_materials_specular with factor 0) become `diffuse`, white metals `roughconductor` without Fresnel, clear
glass `dielectric`; all others `principled`, which is not quite glTF's model. EVENTS are the scattering events of a path.
"""
import json
import math
import os
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

from gltf_arrays import Gltf


def extension(material, name):
    return material.get("extensions", {}).get(name, {})


def texture_of(gltf, slot, raw, channel=None):
    bitmap = mi.Bitmap(str(gltf.image_file(slot["index"])))
    if channel is None:
        return {"type": "bitmap", "bitmap": bitmap, "raw": raw}
    data = np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(data[:, :, channel:channel + 1])), "raw": True}


def glass_of(material, ior, alpha):
    glass = {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0}
    return {**glass, "type": "roughdielectric", "distribution": "ggx", "alpha": alpha} if alpha > 1e-3 else glass


def oracle_of(gltf, material):
    """The material by the plugin that follows glTF's texts; glass by Mitsuba's own, with absorption added."""
    import gltf_bsdf
    pbr = material.get("pbrMetallicRoughness", {})
    if extension(material, "KHR_materials_transmission").get("transmissionFactor", 0) == 1:
        volume = extension(material, "KHR_materials_volume")
        glass = glass_of(material, extension(material, "KHR_materials_ior").get("ior", 1.5), pbr.get("roughnessFactor", 1) ** 2)
        if "attenuationDistance" not in volume:
            return glass
        sigma = [-math.log(c) / volume["attenuationDistance"] for c in volume["attenuationColor"]]
        return {"type": "attenuated", "inner": glass, "sigma": mi.ScalarColor3f(sigma)}
    textures = {}
    for slot, raw in (("baseColor", False), ("metallicRoughness", True)):
        if slot + "Texture" in pbr:
            textures[slot] = texture_of(gltf, pbr[slot + "Texture"], raw)
    return {"type": "gltf", "index": gltf_bsdf.add(material, textures)}


def bsdf_of(gltf, material):
    pbr = material.get("pbrMetallicRoughness", {})
    color, metallic = pbr.get("baseColorFactor", [1, 1, 1, 1])[:3], pbr.get("metallicFactor", 1)
    roughness = pbr.get("roughnessFactor", 1)
    ior = extension(material, "KHR_materials_ior").get("ior", 1.5)
    base = {"type": "rgb", "value": color}
    if "baseColorTexture" in pbr:
        base = texture_of(gltf, pbr["baseColorTexture"], False)
    textured = "metallicRoughnessTexture" in pbr
    if extension(material, "KHR_materials_transmission").get("transmissionFactor", 0) == 1:
        return glass_of(material, ior, roughness ** 2)
    if metallic == 0 and extension(material, "KHR_materials_specular").get("specularFactor", 1) == 0:
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": base}}
    if metallic == 1 and color == [1, 1, 1] and not textured and "baseColorTexture" not in pbr:
        alpha = roughness * roughness
        metal = {"type": "roughconductor", "distribution": "ggx", "alpha": alpha, "material": "none"}
        return {"type": "twosided", "bsdf": metal if alpha > 1e-3 else {"type": "conductor", "material": "none"}}
    bsdf = {"type": "principled", "base_color": base, "roughness": roughness, "metallic": metallic, "specular": 0.5}
    if textured:
        slot = pbr["metallicRoughnessTexture"]
        bsdf["roughness"], bsdf["metallic"] = texture_of(gltf, slot, True, 1), texture_of(gltf, slot, True, 2)
    if "normalTexture" in material:
        bsdf = {"type": "normalmap", "normalmap": texture_of(gltf, material["normalTexture"], True), "bsdf": bsdf}
    return {"type": "twosided", "bsdf": bsdf}


def shape_of(gltf, material, arrays, bsdf):
    smooth, mapped = "normals" in arrays, "uv" in arrays
    mesh = mi.Mesh("mesh", len(arrays["positions"]), len(arrays["faces"]), has_vertex_normals=smooth, has_vertex_texcoords=mapped)
    params = mi.traverse(mesh)
    params["vertex_positions"] = arrays["positions"].astype(np.float32).ravel()
    params["faces"] = arrays["faces"].ravel()
    if smooth:
        params["vertex_normals"] = arrays["normals"].astype(np.float32).ravel()
    if mapped:  # v goes down from the top row in both
        params["vertex_texcoords"] = arrays["uv"].astype(np.float32).ravel()
    params.update()
    with tempfile.NamedTemporaryFile(suffix=".ply", delete=False) as file:
        mesh.write_ply(file.name)
    shape = {"type": "ply", "filename": file.name, "face_normals": not smooth, "bsdf": bsdf}
    if any(material.get("emissiveFactor", [0, 0, 0])):
        strength = extension(material, "KHR_materials_emissive_strength").get("emissiveStrength", 1)
        shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [c * strength for c in material["emissiveFactor"]]}}
    return shape


def light_of(light, world):
    color = {"type": "rgb", "value": [c * light.get("intensity", 1) for c in light.get("color", [1, 1, 1])]}
    place, along = world[:3, 3].tolist(), (-world[:3, 2]).tolist()
    if light["type"] == "directional":
        return {"type": "directional", "direction": along, "irradiance": color}
    if light["type"] == "point":
        return {"type": "point", "position": place, "intensity": color}
    spot = light.get("spot", {})  # between both angles Mitsuba's falloff is another
    to_world = mi.ScalarTransform4f().look_at(place, (world[:3, 3] - world[:3, 2]).tolist(), world[:3, 1].tolist())
    return {"type": "spot", "to_world": to_world, "intensity": color,
            "cutoff_angle": math.degrees(spot.get("outerConeAngle", math.pi / 4)),
            "beam_width": math.degrees(spot.get("innerConeAngle", 0))}


def environment_of(file):
    """Talbot's equirectangular image begins a quarter turn earlier."""
    image = np.array(mi.Bitmap(str(file)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(np.roll(image, -(image.shape[1] // 4), 1)))}


def mitsuba_scene(gltf, width, height, events, oracle=False, environment=None, sampler="independent"):
    if oracle:
        import gltf_bsdf
        gltf_bsdf.register()
    scene = {"type": "scene",
             "integrator": {"type": "path", "max_depth": events + 1, "rr_depth": 5, "hide_emitters": False}}
    yfov, world = gltf.camera()
    eye, forward = world[:3, 3], -world[:3, 2]
    scene["sensor"] = {
        "type": "perspective", "fov": math.degrees(yfov), "fov_axis": "y", "near_clip": 1e-3, "far_clip": 1e5,
        "to_world": mi.ScalarTransform4f().look_at(eye.tolist(), (eye + forward).tolist(), world[:3, 1].tolist()),
        "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                 "component_format": "float32"},
        "sampler": {"type": sampler}}
    if environment:
        scene["environment"] = environment_of(environment)
    elif any(gltf.environment):
        scene["environment"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(gltf.environment)}}
    for number, (name, material, arrays) in enumerate(gltf.primitives()):
        key = "".join(c if c.isalnum() else "_" for c in name)
        bsdf = (oracle_of if oracle else bsdf_of)(gltf, material)
        scene[f"{key}_{number}"] = shape_of(gltf, material, arrays, bsdf)
    for number, (light, world) in enumerate(gltf.lights()):
        scene[f"light_{number}"] = light_of(light, world)
    return mi.load_dict(scene)


def main():
    variant, file, spp, threads, events, seed, scale = sys.argv[1:8]
    mi.set_variant(variant)
    import drjit
    drjit.set_thread_count(int(threads))
    gltf = Gltf(file)
    width, height = gltf.size(float(scale))
    scene = mitsuba_scene(gltf, width, height, int(events))

    def render(samples, number):
        start, cpu = time.perf_counter(), sum(os.times()[:2])
        image = np.array(mi.render(scene, spp=samples, seed=number), np.float32)
        return np.array([time.perf_counter() - start, sum(os.times()[:2]) - cpu]), image

    # The first render compiles; the difference of two lengths takes what is left of set-up out.
    spp = int(spp)
    part = max(1, spp // 8)
    render(part, int(seed) + 10000)
    short, _ = render(part, int(seed) + 20000)
    long, image = render(spp, int(seed))
    seconds, cpu_seconds = (long - short) * spp / (spp - part) if spp > part else long
    print(json.dumps({"mitsuba": mi.__version__, "width": width, "height": height, "spp": spp, "threads": int(threads),
                      "sampling_seconds": seconds, "samples_per_second": width * height * spp / seconds,
                      "samples_per_cpu_second": width * height * spp / cpu_seconds}))
    if len(sys.argv) > 8:
        with open(sys.argv[8], "wb") as out:
            out.write(f"PF\n{width} {height}\n-1.0\n".encode())
            image[::-1, :, :3].astype("<f4").tofile(out)


if __name__ == "__main__":
    main()
