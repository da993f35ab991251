"""The default scene: a still life on a walnut table by a window, with a small warm lamp at the back.

Light comes from four panes on the left and one globe; the rest is a dim even sky. Metres, table top at y = 0.
"""

from math import pi

from . import still_life_textures as paint
from . import vessels
from .geometry import Mesh, after, box, length, panel, quad, sub, turn_y, turn_z
from .napkin import napkin

LIGHT_TARGET = (0.0, 0.1, 0.0)
WALL_Z = -0.78
WINDOW_X = -1.25


def _room(document):
    """Table, back wall, and the window wall on the left with its four panes and crossbars."""
    base, rough, normal = paint.planks(512, 1024, 7, 11)
    wood = document.material("walnut", roughness=1.0, normal_scale=1.0, textures={
        "base": document.texture("walnut base", base), "roughness": document.texture("walnut roughness", rough),
        "normal": document.texture("walnut normal", normal)})
    stops = ((0.0, (0.045, 0.075, 0.085)), (0.5, (0.085, 0.135, 0.145)), (1.0, (0.14, 0.20, 0.205)))
    base, normal = paint.plaster(512, 23, stops)
    wall = document.material("plaster", roughness=0.85, normal_scale=0.8, textures={
        "base": document.texture("plaster base", base), "normal": document.texture("plaster normal", normal)})
    frame = document.material("window frame", (0.62, 0.60, 0.55), roughness=0.5)
    table = quad((-1.2, 0.0, 0.75), (3.0, 0.0, 0.0), (0.0, 0.0, WALL_Z - 0.75), (2.75, 1.4), (0.37, 0.0))
    table.append(quad((-1.2, -0.04, 0.75), (3.0, 0.0, 0.0), (0.0, 0.04, 0.0), (2.75, 0.04), (0.37, 0.41)))
    document.node("table", document.mesh("table", (table, wood)))
    document.node("wall", document.mesh("wall", (
        quad((-1.8, 0.0, WALL_Z), (4.4, 0.0, 0.0), (0.0, 2.0, 0.0), (3.3, 1.5)), wall)))
    day = document.material("daylight", (0.0, 0.0, 0.0), lambert=True, emission=(11.0, 10.8, 10.4))
    panes, bars = Mesh(), Mesh()
    for column in range(2):
        for row in range(2):
            z, y = -0.53 + 0.56 * column, 0.18 + 0.62 * row
            panes.append(quad((WINDOW_X, y, z + 0.52), (0.0, 0.0, -0.52), (0.0, 0.58, 0.0)))
    for z in (-0.55, 0.01, 0.57):
        bars.append(box((0.04, 1.28, 0.04), (WINDOW_X, 0.78, z)))
    for y in (0.16, 0.78, 1.40):
        for z in (-0.27, 0.29):
            bars.append(box((0.04, 0.04, 0.52), (WINDOW_X, y, z)))
    document.node("window", document.mesh("window", (panes, day)))
    sky = document.material("skylight", (0.0, 0.0, 0.0), lambert=True, emission=(2.4, 2.6, 3.0))
    document.node("skylight", document.mesh("skylight", (panel((0.75, 1.45, 0.75), LIGHT_TARGET, 1.0, 0.6), sky)))
    document.node("window bars", document.mesh("window bars", (bars, frame)))


def _glass(document):
    """The bodies of glass: a bottle with its cork, a goblet and an exact sphere."""
    green = document.material("green glass", roughness=0.0, ior=1.52, transmission=1.0, thickness=0.0027,
                              attenuation=((0.46, 0.68, 0.24), 0.006))
    rose = document.material("rose glass", roughness=0.0, ior=1.5, transmission=1.0, thickness=0.0013,
                             attenuation=((0.98, 0.62, 0.58), 0.008))
    clear = document.material("clear glass", roughness=0.0, ior=1.5, transmission=1.0, thickness=0.08)
    cork = document.material("cork", (0.48, 0.30, 0.17), roughness=0.9)
    document.node("bottle", document.mesh("bottle", (vessels.bottle(), green)), (-0.245, 0.0027, -0.185))
    document.node("cork", document.mesh("cork", (vessels.cork(), cork)), (-0.245, 0.0027, -0.185))
    document.node("goblet", document.mesh("goblet", (vessels.goblet(), rose)), (-0.125, 0.0027, -0.095))
    document.sphere("glass ball", (0.035, 0.0421, 0.15), 0.042, clear)


def _metal(document):
    """A silver vase, a turned tray and a gold queen."""
    rough, normal = paint.turned_metal(256, 512, 41)
    tray = document.material("turned copper", (0.93, 0.62, 0.47), metallic=1.0, roughness=1.0, textures={
        "roughness": document.texture("turned roughness", rough),
        "normal": document.texture("turned normal", normal)})
    silver = document.material("polished silver", (0.95, 0.93, 0.90), metallic=1.0, roughness=0.09)
    gold = document.material("rough gold", (1.0, 0.74, 0.32), metallic=1.0, roughness=0.33)
    document.node("tray", document.mesh("tray", (vessels.tray().with_tangents(), tray)), (-0.20, 0.0, -0.14))
    document.node("vase", document.mesh("vase", (vessels.vase(), silver)), (0.015, 0.0, -0.235))
    document.node("queen", document.mesh("queen", (vessels.queen(), gold)), (-0.250, 0.0, 0.105))


def _ceramics(document):
    """A porcelain teapot, a glazed bowl, and the pawns."""
    porcelain = document.material("porcelain", (0.86, 0.85, 0.82), roughness=0.08)
    base, rough = paint.glaze(512, 256, 31)
    glazed = document.material("sea glaze", roughness=1.0, textures={
        "base": document.texture("glaze base", base), "roughness": document.texture("glaze roughness", rough)})
    ivory = document.material("ivory", (0.78, 0.69, 0.53), roughness=0.3)
    ebony = document.material("ebony", (0.022, 0.018, 0.016), roughness=0.22)
    teapot = document.mesh("teapot", (vessels.teapot(), porcelain))
    document.node("teapot", teapot, (0.155, 0.0, -0.03), turn_y(-2.6))
    document.node("bowl", document.mesh("bowl", (vessels.bowl(), glazed)), (0.315, 0.0, -0.225))
    ebony_pawn = document.mesh("ebony pawn", (vessels.pawn(), ebony))
    document.node("ivory pawn", document.mesh("ivory pawn", (vessels.pawn(), ivory)), (-0.195, 0.0, 0.155))
    document.node("ebony pawn", ebony_pawn, (-0.325, 0.0, 0.03))
    # Lying on its base rim and its head: the axis leans by asin((base - head) / distance) from the table.
    document.node("fallen pawn", ebony_pawn, (-0.145, 0.0139, 0.245), after(turn_y(0.5), turn_z(-pi / 2 - 0.11)))


def _fruit(document):
    base, normal = paint.peel(256, 51)
    textures = {"base": document.texture("peel base", base), "normal": document.texture("peel normal", normal)}
    orange = document.material("orange", (0.92, 0.33, 0.035), roughness=0.42, textures=textures, normal_scale=0.7)
    lemon = document.material("lemon", (1.0, 0.74, 0.085), roughness=0.38, textures=textures, normal_scale=0.7)
    orange_mesh = document.mesh("orange", (vessels.fruit(0.037), orange))
    lemon_mesh = document.mesh("lemon", (vessels.lemon(), lemon))
    x, z = 0.315, -0.225
    places = (((x - 0.040, 0.026, z + 0.025), (0.3, 0.2)), ((x + 0.038, 0.027, z + 0.022), (1.5, -0.35)),
              ((x + 0.002, 0.027, z - 0.045), (2.5, 0.3)), ((x - 0.001, 0.075, z + 0.001), (0.8, 0.5)))
    for number, (place, (heading, lean)) in enumerate(places):
        document.node(f"orange {number}", orange_mesh, place, after(turn_y(heading), turn_z(lean)))
    document.node("orange on the table", orange_mesh, (0.330, 0.0035, -0.020), after(turn_y(0.4), turn_z(0.3)))
    document.node("lemon", lemon_mesh, (0.225, 0.0288, 0.150), after(turn_y(0.75), turn_z(-pi / 2)))


def _napkin(document):
    linen = document.material("linen", roughness=0.9, two_sided=True, textures={
        "base": document.texture("linen base", paint.linen(256, 61))})
    cloth = document.mesh("napkin", (napkin(0.28, 0.21, 96, 72, 71), linen))
    document.node("napkin", cloth, (0.235, 0.0, 0.150), turn_y(0.3))


def _lamp(document):
    brass = document.material("brass", (0.88, 0.67, 0.36), metallic=1.0, roughness=0.22)
    globe = document.material("lamp globe", (0.0, 0.0, 0.0), lambert=True, emission=(6.5, 3.4, 1.3))
    place = (0.435, 0.0, -0.50)
    document.node("lamp stand", document.mesh("lamp stand", (vessels.lamp_stand(), brass)), place)
    document.sphere("lamp globe", (place[0], 0.156, place[2]), 0.052, globe)


def build(document):
    _room(document)
    _metal(document)
    _glass(document)
    _ceramics(document)
    _fruit(document)
    _napkin(document)
    _lamp(document)
    document.environment(gradient=((-0.48, 0.64, 0.6), (0.035, 0.026, 0.02), (0.22, 0.24, 0.28)))
    eye, target = (0.025, 0.27, 1.06), (0.025, 0.097, -0.05)
    document.camera("still life", eye, target, 24 * pi / 180, (960, 540), lens=(0.0055, 1.02))
    eye, target = (-0.42, 0.11, 0.52), (-0.10, 0.045, 0.08)
    focus = length(sub(eye, target)) - 0.02
    document.camera("chess pieces", eye, target, 30 * pi / 180, (960, 540), lens=(0.006, focus))
