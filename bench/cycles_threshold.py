"""Run inside Blender: one render of a glTF scene with Cycles on the CPU, ended by its noise threshold.

blender -b --factory-startup -P cycles_threshold.py -- SCENE.gltf MAX_SPP THRESHOLD SCALE THREADS SEED OUTPUT.pfm
THRESHOLD 0 renders MAX_SPP samples everywhere. Settings as in cycles_scene.py: no denoiser, no clamping, caustics on.
"""
import json
import sys

import bpy
import numpy

# Blender 3.4's importer still uses the aliases that newer NumPy has dropped.
for alias, kind in (("bool", bool), ("int", int), ("float", float)):
    if alias not in numpy.__dict__:
        setattr(numpy, alias, kind)

args = sys.argv[sys.argv.index("--") + 1:]
scene_file, spp, threshold, scale, threads, seed, output = (args[0], int(args[1]), float(args[2]), float(args[3]), int(args[4]),
                                                            int(args[5]), args[6])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=scene_file)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.camera = next(o for o in bpy.data.objects if o.type == "CAMERA")
doc = json.load(open(scene_file))
width, height = (max(1, round(side * scale)) for side in doc["cameras"][0].get("extras", {}).get("resolution", [512, 512]))
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
scene.render.threads_mode, scene.render.threads = "FIXED", threads
c = scene.cycles
c.device, c.samples, c.seed, c.use_denoising = "CPU", spp, seed, False
c.use_adaptive_sampling = threshold > 0
if threshold > 0:
    c.adaptive_threshold, c.adaptive_min_samples = threshold, 0
c.sample_clamp_direct = c.sample_clamp_indirect = 0
c.blur_glossy, c.caustics_reflective, c.caustics_refractive = 0, True, True
c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = 8
c.pixel_filter_type, c.filter_width = "BOX", 1.0
world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
color = doc["scenes"][0].get("extras", {}).get("environment", {}).get("color", [0, 0, 0])
world.node_tree.nodes["Background"].inputs[0].default_value = (*color, 1)
scene.view_settings.view_transform = "Standard"
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = output + ".exr"
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(scene.render.filepath)
pixels = numpy.empty(width * height * 4, numpy.float32)
image.pixels.foreach_get(pixels)
with open(output, "wb") as file:  # Blender's rows and those of a PFM go from the bottom up
    file.write(f"PF\n{width} {height}\n-1.0\n".encode())
    pixels.reshape(-1, 4)[:, :3].astype("<f4").tofile(file)
