#!/usr/bin/env python3
"""Rewrites sources of the core so that they calculate in double: float becomes double, literals lose their suffix, the
namespace talbot becomes talbot_double and includes of core/ lead to the rewritten files. The few places that look at the bits
of a float or name its precision are replaced one by one, and each must be found.

Usage: translate.py SOURCE_DIR OUTPUT_DIR FILE..."""
import pathlib
import re
import sys

DECIMAL = re.compile(r"(?<![\w.])((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[fF]\b")
HEXADECIMAL = re.compile(r"\b(0x[0-9a-fA-F]*\.?[0-9a-fA-F]*p[+-]?\d+)f\b")

# By file: what stands there after the general rules, and what it becomes.
REPLACEMENTS = {
    "core/math/vec.h": [
        # A type of its own beside Vec3d, as in the core, so that overloads stay apart.
        ("using Vec2f = glm::vec2;", "using Vec2f = glm::vec<2, double, glm::mediump>;"),
        ("using Vec3f = glm::vec3;", "using Vec3f = glm::vec<3, double, glm::mediump>;"),
        ("using Vec4f = glm::vec4;", "using Vec4f = glm::vec<4, double, glm::mediump>;"),
        ("using Mat3f = glm::mat3;", "using Mat3f = glm::mat<3, 3, double, glm::mediump>;"),
        ("using Rgb = glm::vec3;", "using Rgb = Vec3f;"),
        ("__builtin_huge_valf()", "__builtin_huge_val()"),
    ],
    "core/math/robust.h": [
        ("kFloatEpsilon = 0x1p-24", "kFloatEpsilon = 0x1p-53"),
        ("kOneMinusEpsilon = 0x1.fffffep-1", "kOneMinusEpsilon = 0x1.fffffffffffffp-1"),
        ("""inline bool is_finite(double x) {
    return (std::bit_cast<uint32_t>(x) & 0x7F800000u) != 0x7F800000u;
}
""", ""),
        ("""    if (x == 0) return std::bit_cast<double>(1u);
    const uint32_t bits = std::bit_cast<uint32_t>(x);
    return std::bit_cast<double>(x > 0 ? bits + 1 : bits - 1);
""", "    return std::nextafter(x, std::numeric_limits<double>::infinity());\n"),
        ("#include <cstdint>\n", "#include <cstdint>\n#include <limits>\n"),
    ],
    "core/math/warp.h": [
        # Sine and cosine themselves instead of a series that is good for float.
        (re.compile(r"    const double x2 = x \* x;\n    sine =\n.*?\n    cosine = [^\n]*\n", re.S),
         "    sine = std::sin(x);\n    cosine = std::cos(x);\n"),
        (re.compile(r"    const uint32_t bits_a = .*?b = std::bit_cast<double>\(bits_b \^ change\);\n", re.S),
         "    if (swapped) std::swap(a, b);\n"),
        ("    return std::bit_cast<double>(std::bit_cast<uint32_t>(x) ^ (bit << 31));\n",
         "    return bit != 0 ? -x : x;\n"),
        ("#include <cstdint>\n", "#include <cstdint>\n#include <utility>\n"),
    ],
}


def translate(text, name):
    text = re.sub(r"\bfloat\b", "double", text)
    text = DECIMAL.sub(r"\1", HEXADECIMAL.sub(r"\1", text))
    text = re.sub(r"\bnamespace talbot\b", "namespace talbot_double", text)
    text = re.sub(r"\btalbot::", "talbot_double::", text)
    text = re.sub(r"\bTALBOT_(?!CHECKS\b|WITHOUT_EFFECT\b)", "TALBOT_DOUBLE_", text)
    text = re.sub(r'#include "(core/|oracles/twin/record_path\.h)', r'#include "double/\1', text)
    for old, new in REPLACEMENTS.get(name, []):
        if isinstance(old, str):
            found = text.count(old)
            text = text.replace(old, new, 1)
        else:
            text, found = old.subn(lambda _: new, text, count=1)
        if found != 1:
            sys.exit(f"translate.py: {name}: {found} places instead of one for the replacement by '{new.strip()}'; "
                     "the source has changed: adapt REPLACEMENTS")
    return text


def main():
    source, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    for name in sys.argv[3:]:
        file = output / "double" / name
        text = translate((source / name).read_text(), name)
        # Untouched where nothing changed, so that nothing is compiled again.
        if file.exists() and file.read_text() == text:
            continue
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


if __name__ == "__main__":
    main()
