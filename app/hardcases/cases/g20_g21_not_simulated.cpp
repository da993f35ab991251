// G20 and G21: shapes and effects that Talbot does not have.
#include "app/hardcases/hard_case.h"

namespace talbot::hardcases::g20 {
namespace {

const bool kShapes = add_not_simulated(
    {"G20", "curves, cylinders, cones, discs, bilinear patches",
     "glTF has triangles; Talbot adds exact spheres (G11, G12) and nothing else"});

const bool kMotion = add_not_simulated(
    {"G21", "motion blur inside a ray's time",
     "with --shutter every sample has an instant of its own, at which the scene stands still"});

}  // namespace
}  // namespace talbot::hardcases::g20
