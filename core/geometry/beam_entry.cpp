// Opens a tree for a beam: nodes are replaced by those of their children that a ray of the beam can
// meet, as long as eight are enough to name all of them. Compiled once for every instruction set
// that Highway offers; the choice of parts changes no hit, for none that can be met is left out.
// After Reshetov, Soupikov, Hurley 2005, "Multi-level ray tracing algorithm", with intervals in
// place of a frustum.
// The Highway headers come first, and lane_pack.h is read again for every target.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/geometry/beam_entry.cpp"
#include <algorithm>
#include <limits>

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "core/geometry/beam_entry.h"
#include "core/math/robust_geometry.h"
#include "core/geometry/lane_pack.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace talbot {
namespace HWY_NAMESPACE {

using Boxes = Pack<kNodeWidth>;

// Bounds of t over all rays of a beam and both planes of a box along one axis, from the interval of
// origins and the reciprocals of the ends of that of directions.
struct BeamAxis {
    enum class Way { up, down, both };

    Boxes first_origin, last_origin;
    Boxes by_first, by_last;
    Way way;

    HWY_INLINE BeamAxis(const Beam& beam, int axis)
        : first_origin(Boxes::set(beam.origins.lower[axis])),
          last_origin(Boxes::set(beam.origins.upper[axis])) {
        float first = beam.directions.lower[axis];
        float last = beam.directions.upper[axis];
        way = first >= kLeastBeamSlope ? Way::up : last <= -kLeastBeamSlope ? Way::down : Way::both;
        if (way == Way::both) {
            first = std::min(first, -kLeastBeamSlope);
            last = std::max(last, kLeastBeamSlope);
        }
        by_first = Boxes::set(1 / first);
        by_last = Boxes::set(1 / last);
    }

    HWY_INLINE void cut(const float* lower, const float* upper, Boxes& enter, Boxes& leave) const {
        const Boxes to_lower = sub(Boxes::load(lower), last_origin);
        const Boxes to_upper = sub(Boxes::load(upper), first_origin);
        switch (way) {
            case Way::up:
                enter = max(enter, mul(to_lower, by_last));
                leave = min(leave, mul(to_upper, by_first));
                break;
            case Way::down:
                enter = max(enter, mul(to_upper, by_first));
                leave = min(leave, mul(to_lower, by_last));
                break;
            case Way::both:
                enter = max(enter, max(mul(to_lower, by_last), mul(to_upper, by_first)));
                break;
        }
    }
};

class BeamOpener {
  public:
    HWY_INLINE BeamOpener(const Tree& tree, const Beam& beam)
        : tree_(tree), axes_{BeamAxis(beam, 0), BeamAxis(beam, 1), BeamAxis(beam, 2)} {}

    HWY_INLINE void open(WideNode& out) {
        Part parts[kNodeWidth];
        uint32_t count = meet(tree_.nodes[tree_.root], parts);
        for (int opened = 1; opened < kMostOpened; ++opened) {
            Part* const largest = std::max_element(parts, parts + count, smaller);
            if (largest == parts + count || largest->area < 0) break;
            Part children[kNodeWidth];
            const uint32_t more = meet(tree_.nodes[largest->node->child[largest->lane]], children);
            if (count - 1 + more > kNodeWidth) {
                largest->area = kClosed;
                continue;
            }
            *largest = parts[--count];
            std::copy_n(children, more, parts + count);
            count += more;
        }
        write(parts, count, out);
    }

  private:
    static constexpr float kClosed = -1;  // leaves, and nodes whose children are too many
    // Nearly all that can be opened is then.
    static constexpr int kMostOpened = 20;

    struct Part {
        const WideNode* node;
        uint32_t lane;
        float area;
    };
    static bool smaller(const Part& a, const Part& b) { return a.area < b.area; }

    // The children that the beam meets; their number.
    HWY_INLINE uint32_t meet(const WideNode& node, Part* out) const {
        Boxes enter = Boxes::set(0);
        Boxes leave = Boxes::set(std::numeric_limits<float>::infinity());
        for (int i = 0; i < 3; ++i)
            axes_[i].cut(node.plane[2 * i], node.plane[2 * i + 1], enter, leave);
        const Boxes room = add(mul(leave, Boxes::set(1 + kBeamPad)), Boxes::set(kLeastBeamTime));
        const auto met = both(less_equal(mul(enter, Boxes::set(1 - kBeamPad)), room),
                              less_equal(Boxes::load(node.plane[0]), Boxes::load(node.plane[1])));
        uint32_t count = 0;
        for (uint32_t bits = met.bits(); bits != 0; bits &= bits - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(bits));
            out[count++] = {&node, lane, area(node, lane)};
        }
        return count;
    }

    HWY_INLINE static float area(const WideNode& node, uint32_t lane) {
        if (ChildRef::is_leaf(node.child[lane])) return kClosed;
        const float x = node.plane[1][lane] - node.plane[0][lane];
        const float y = node.plane[3][lane] - node.plane[2][lane];
        const float z = node.plane[5][lane] - node.plane[4][lane];
        return x * y + y * z + z * x;
    }

    HWY_INLINE static void write(const Part* parts, uint32_t count, WideNode& out) {
        for (uint32_t i = 0; i < kNodeWidth; ++i) {
            for (uint32_t plane = 0; plane < 6; ++plane) {
                constexpr float kInf = std::numeric_limits<float>::infinity();
                const float none = plane % 2 == 0 ? kInf : -kInf;
                out.plane[plane][i] = i < count ? parts[i].node->plane[plane][parts[i].lane] : none;
            }
            out.child[i] = i < count ? parts[i].node->child[parts[i].lane] : kUnusedChild;
        }
    }

    const Tree& tree_;
    BeamAxis axes_[3];
};

void open_for_beam(const Tree& tree, const Beam& beam, WideNode& out) {
    BeamOpener(tree, beam).open(out);
}

}  // namespace HWY_NAMESPACE
}  // namespace talbot
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talbot {

HWY_EXPORT(open_for_beam);

void find_beam_entry(const Tree& tree, const Beam& beam, BeamEntry& entry) {
    const bool usable = !tree.is_empty && !ChildRef::is_leaf(tree.root) &&
                        beam.origins.largest_coordinate() <= kMaxCoordinate &&
                        beam.directions.largest_coordinate() <= kMaxDirection;
    entry.is_root = !usable;
    if (!usable) return;
    Beam wide = beam;
    if (!tree.objects.empty()) {
        // As for single rays: they are rounded again in the space of an instance.
        const float pad =
            static_cast<float>(kInstanceBoundsPad) * beam.origins.largest_coordinate();
        wide.origins.lower -= pad;
        wide.origins.upper += pad;
    }
    HWY_DYNAMIC_DISPATCH(open_for_beam)(tree, wide, entry.node);
}

}  // namespace talbot
#endif
