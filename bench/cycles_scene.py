"""Run inside Blender: renders a glTF scene with Cycles on the CPU and prints the seconds of sampling.

blender -b --factory-startup -P cycles_scene.py -- SCENE.gltf SPP THREADS BOUNCES [OUTPUT.pfm [SEED [SCALE]]]
No denoiser, no clamping, no adaptive sampling, caustics on, 1 px box filter: the settings that estimate the same image as
Talbot's.
"""
import json
import os
import sys
import time

import bpy
import numpy

# Blender 3.4's importer still uses the aliases that newer NumPy has dropped.
for alias, kind in (("bool", bool), ("int", int), ("float", float)):
    if alias not in numpy.__dict__:
        setattr(numpy, alias, kind)

args = sys.argv[sys.argv.index("--") + 1:]
scene_file, spp, threads, bounces = args[0], int(args[1]), int(args[2]), int(args[3])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=scene_file)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA")
doc = json.load(open(scene_file))
width, height = doc["cameras"][0].get("extras", {}).get("resolution", [512, 512])
scale = float(args[6]) if len(args) > 6 else 1
width, height = max(1, round(width * scale)), max(1, round(height * scale))
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
scene.render.threads_mode, scene.render.threads = "FIXED", threads
c = scene.cycles
c.seed = int(args[5]) if len(args) > 5 else 0
c.device, c.samples, c.use_adaptive_sampling, c.use_denoising = "CPU", spp, False, False
c.sample_clamp_direct = c.sample_clamp_indirect = 0
c.blur_glossy, c.caustics_reflective, c.caustics_refractive = 0, True, True
c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = bounces
c.pixel_filter_type, c.filter_width = "BOX", 1.0
world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
color = doc["scenes"][0].get("extras", {}).get("environment", {}).get("color", [0, 0, 0])
world.node_tree.nodes["Background"].inputs[0].default_value = (*color, 1)
scene.view_settings.view_transform = "Standard"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = "/dev/shm/cycles_scene.exr"


def render(samples):
    c.samples = samples
    start, cpu = time.perf_counter(), sum(os.times()[:2])
    bpy.ops.render.render(write_still=True)
    return numpy.array([time.perf_counter() - start, sum(os.times()[:2]) - cpu])


# The difference of two lengths takes set-up and writing out.
short = render(max(1, spp // 8))
long = render(spp)
seconds, cpu_seconds = (long - short) * spp / (spp - max(1, spp // 8))
print(json.dumps({"cycles": bpy.app.version_string, "width": width, "height": height, "spp": spp, "threads": threads,
                  "sampling_seconds": seconds, "samples_per_second": width * height * spp / seconds,
                  "samples_per_cpu_second": width * height * spp / cpu_seconds}))
if len(args) > 4:
    image = bpy.data.images.load(scene.render.filepath)
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    with open(args[4], "wb") as file:  # Blender's rows and those of a PFM go from the bottom up
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        pixels.reshape(-1, 4)[:, :3].astype("<f4").tofile(file)
