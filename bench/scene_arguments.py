"""What the benchmarks over scenes have in common on the command line: the program, scenes, --quick and --json."""
import argparse
import pathlib

CORNELL = pathlib.Path(__file__).resolve().parent.parent / "assets/scenes/cornell.gltf"


def scene_parser(description, quick):
    """`quick` says what --quick makes small."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scene", nargs="*")
    parser.add_argument("--scenes", help="a folder: its .gltf files with separate buffers")
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--json")
    return parser


def scenes_in(folder):
    """The .gltf files of a folder with separate buffers, by name."""
    return [str(f) for f in sorted(pathlib.Path(folder).glob("*.gltf")) if "uri\": \"data:" not in f.read_text()]


def scenes_of(args):
    """Those that the arguments name, else the built-in Cornell box."""
    return args.scene + (scenes_in(args.scenes) if args.scenes else []) or [str(CORNELL)]
