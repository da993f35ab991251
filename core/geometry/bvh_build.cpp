// Top-down build: a node takes up to eight children by splitting the child of largest area again
// and again. The upper levels are built first, then their subtrees in parallel, each into its own
// arrays, joined in a fixed order: the tree does not depend on the number of threads. References:
// Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"; Wald et al. 2008,
// "Getting rid of packets" (wide trees).
#include "core/geometry/bvh_build.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/geometry/spatial_split.h"
#include "core/geometry/split_search.h"

namespace talbot {
namespace {

constexpr uint64_t kSubtreeSize =
    4096;  // primitives that one task takes at most, if the range can be split

// Cuts through triangles are looked for where the boxes of the two parts of a split share so much
// of the node's half surface and of the root's, and taken when they cost less than the last share.
constexpr double kOverlapOfNode = 0.1;
constexpr double kOverlapOfRoot = 1.0 / 8192;
constexpr double kWorthCutting = 0.9;

class Builder {
  public:
    // The pool's workers read large ranges together; what they build themselves needs a builder
    // without a pool.
    Builder(std::span<BuildPrimitive> primitives, BuildQuality quality, const LoadTriangle& load,
            WorkerPool* pool, std::stop_token stop)
        : primitives_(primitives),
          quality_(quality),
          load_(load),
          pool_(pool),
          stop_(std::move(stop)) {}

    // All primitives, with the places behind them.
    Range whole(uint64_t count, uint64_t room) {
        Range range = read_range(0, count);
        least_overlap_ = kOverlapOfRoot * range.box.half_area();
        range.room = room;
        choose_split(range, 0);
        return range;
    }

    Builder without_pool() const {
        Builder builder = *this;
        builder.pool_ = nullptr;
        return builder;
    }

    // Splits `range` into up to eight children, in the order of descending size: searches that any
    // hit ends look at the last one first, and a small one answers soonest.
    std::vector<Range> split_wide(const Range& range, uint32_t depth) {
        std::vector<Range> children{range};
        children.reserve(kNodeWidth);
        while (children.size() < kNodeWidth) {
            size_t best = children.size();
            double best_key = -1;
            for (size_t i = 0; i < children.size(); ++i) {
                if (!children[i].is_worth_splitting) continue;
                // Past the depth limit the largest count goes first, so that every level divides it
                // by eight.
                const double key = depth < kMaxAreaDepth ? children[i].box.half_area()
                                                         : static_cast<double>(children[i].size());
                if (key > best_key) {
                    best_key = key;
                    best = i;
                }
            }
            if (best == children.size()) break;
            Range first;
            Range second;
            split(children[best], first, second);
            first.crowd = second.crowd = children[best].crowd;
            choose_split(first, depth);
            choose_split(second, depth);
            children[best] = first;
            children.push_back(second);
        }
        std::stable_sort(children.begin(), children.end(),
                         [](const Range& a, const Range& b) { return a.size() > b.size(); });
        return children;
    }

    // Builds the subtree below `range` into `tree` and returns its reference.
    uint32_t build(const Range& range, uint32_t depth, Tree& tree) {
        if (range.crowd > tree.crowd) {
            tree.crowd = range.crowd;
            tree.crowd_number = primitives_[range.begin].index;
        }
        if (range.is_leaf) return make_leaf(range, tree);
        TALBOT_CHECK(depth < kMaxDepth);
        tree.depth = std::max(tree.depth, depth + 1);
        const uint64_t index = tree.nodes.size();
        tree.nodes.emplace_back();
        if (stop_.stop_requested()) return ChildRef::inner(index);
        const std::vector<Range> children = split_wide(range, depth);
        std::array<uint32_t, kNodeWidth> refs{};
        for (size_t i = 0; i < children.size(); ++i) refs[i] = build(children[i], depth + 1, tree);
        fill_node(tree.nodes[index], children, refs);
        return ChildRef::inner(index);
    }

    static void fill_node(WideNode& node, const std::vector<Range>& children,
                          const std::array<uint32_t, kNodeWidth>& refs) {
        for (size_t i = 0; i < kNodeWidth; ++i) {
            const bool used = i < children.size();
            const Box box = used ? children[i].box : Box{};
            for (size_t axis = 0; axis < 3; ++axis) {
                node.plane[2 * axis][i] = box.lower[axis];
                node.plane[2 * axis + 1][i] = box.upper[axis];
            }
            node.child[i] = used ? refs[i] : kUnusedChild;
        }
    }

    uint32_t make_leaf(const Range& range, Tree& tree) const {
        const std::span<BuildPrimitive> items = primitives_.subspan(range.begin, range.size());
        if (items[0].instance == kObjectPrimitive) {
            const uint64_t first = tree.objects.size();
            for (const BuildPrimitive& p : items) tree.objects.push_back(p.index);
            return ChildRef::leaf(first, items.size(), true);
        }
        const uint64_t first = tree.blocks.size();
        for (size_t i = 0; i < items.size(); ++i) {
            if (i % kBlockWidth == 0) tree.blocks.push_back(empty_block());
            store_triangle(load_(items[i]), items[i].index, tree.blocks.back(),
                           static_cast<uint32_t>(i % kBlockWidth));
        }
        tree.references += items.size();
        return ChildRef::leaf(first, blocks_of(items.size()), false);
    }

  private:
    static TriangleBlock empty_block() {
        TriangleBlock block{};
        for (auto& vertex : block.vertex) {
            for (auto& axis : vertex)
                std::fill(std::begin(axis), std::end(axis),
                          std::numeric_limits<float>::quiet_NaN());
        }
        std::fill(std::begin(block.number), std::end(block.number), kNoId);
        return block;
    }

    Range read_range(uint64_t begin, uint64_t end) const {
        Range range;
        range.begin = begin;
        range.end = end;
        if (pool_ == nullptr || end - begin < 2 * kPieceSize) {
            for (uint64_t i = begin; i < end; ++i) range.add(primitives_[i]);
            return range;
        }
        std::vector<Range> pieces((end - begin + kPieceSize - 1) / kPieceSize);
        pool_->parallel_for(pieces.size(), [&](uint64_t piece, unsigned) {
            const uint64_t first = begin + piece * kPieceSize;
            for (uint64_t i = first; i < std::min(end, first + kPieceSize); ++i)
                pieces[piece].add(primitives_[i]);
        });
        for (const Range& piece : pieces) range.add(piece);
        return range;
    }

    // Decides whether the range is a leaf, and else where it is split.
    void choose_split(Range& range, uint32_t depth) const {
        if (range.is_crowd()) range.crowd = std::max(range.crowd, range.size());
        // Objects and triangles never share a leaf, and objects have leaves of their own.
        const bool may_be_leaf =
            range.objects == 0 ? range.size() <= kMaxLeafItems * kBlockWidth : range.size() == 1;
        if (range.size() == 1 || (may_be_leaf && range.size() <= kBlockWidth)) {
            range.is_leaf = true;
            range.is_worth_splitting = false;
            return;
        }
        double children_cost = kInfinity;
        if (depth < kMaxAreaDepth) {
            const auto primitives = primitives_.subspan(range.begin, range.size());
            const SplitCost split = search_split(primitives, quality_, pool_, range);
            children_cost = split.cost;
            if (range.room > 0 && range.objects == 0 &&
                split.overlap > std::max(kOverlapOfNode * range.box.half_area(), least_overlap_)) {
                const SpatialSplit cut = search_spatial_split(primitives, load_, pool_, range);
                if (cut.cost < kWorthCutting * split.cost && cut.cut <= range.room) {
                    children_cost = cut.cost;
                    range.is_spatial = true;
                    range.axis = cut.axis;
                    range.split_bin = cut.bin;
                }
            }
        }
        if (!may_be_leaf) return;
        const double leaf_cost =
            static_cast<double>(blocks_of(range.size())) * range.box.half_area();
        range.is_leaf = leaf_cost <= children_cost + range.box.half_area();
        range.is_worth_splitting = children_cost < leaf_cost;
    }

    // Orders the range's primitives for its split and says what the two parts are.
    void split(const Range& range, Range& first, Range& second) {
        bool done = false;
        if (range.is_spatial) {
            done = partition_spatially(primitives_.subspan(range.begin, range.size() + range.room),
                                       load_, range, first, second);
        } else if (range.axis != Range::kNoAxis) {
            const auto primitives = primitives_.subspan(range.begin, range.size());
            first.begin = range.begin;
            first.end = second.begin =
                range.begin + partition_range(primitives, quality_, range, first, second);
            second.end = range.end;
            done = true;
        }
        if (!done) {
            const uint64_t middle = halve(range);
            first = read_range(range.begin, middle);
            second = read_range(middle, range.end);
        }
        share_room(range.end + range.room - second.end, first, second);
    }

    // Divides the places behind two parts among them by their size.
    void share_room(uint64_t room, Range& first, Range& second) {
        if (room == 0) return;
        const double share =
            static_cast<double>(first.size()) / static_cast<double>(first.size() + second.size());
        first.room = static_cast<uint64_t>(share * static_cast<double>(room));
        second.room = room - first.room;
        // As many as must go from the beginning of the second part go to its end.
        const uint64_t moved = std::min(first.room, second.size());
        const auto from = primitives_.begin() + static_cast<std::ptrdiff_t>(second.begin);
        second.begin += first.room;
        second.end += first.room;
        std::copy(from, from + static_cast<std::ptrdiff_t>(moved),
                  primitives_.begin() + static_cast<std::ptrdiff_t>(second.end - moved));
    }

    uint64_t halve(const Range& range) {
        const auto first = primitives_.begin() + static_cast<std::ptrdiff_t>(range.begin);
        const auto last = primitives_.begin() + static_cast<std::ptrdiff_t>(range.end);
        const auto kinds = range.objects > 0
                               ? std::partition(first, last,
                                                [](const BuildPrimitive& p) {
                                                    return p.instance != kObjectPrimitive;
                                                })
                               : first;
        if (kinds != first && kinds != last && range.size() <= kMaxLeafItems * kBlockWidth) {
            return static_cast<uint64_t>(kinds - primitives_.begin());
        }
        const Float4 e = range.centroids.upper - range.centroids.lower;
        const int axis = e[0] > e[1] ? (e[0] > e[2] ? 0 : 2) : (e[1] > e[2] ? 1 : 2);
        const auto middle = first + static_cast<std::ptrdiff_t>(range.size() / 2);
        if (e[axis] > 0) {
            std::nth_element(
                first, middle, last, [axis](const BuildPrimitive& p, const BuildPrimitive& q) {
                    return p.lower[axis] + p.upper[axis] < q.lower[axis] + q.upper[axis];
                });
        }
        return static_cast<uint64_t>(middle - primitives_.begin());
    }

    std::span<BuildPrimitive> primitives_;
    BuildQuality quality_;
    const LoadTriangle& load_;
    WorkerPool* pool_;
    std::stop_token stop_;
    double least_overlap_ = 0;
};

// The upper levels: nodes whose children are further such nodes or subtrees left to the tasks.
struct UpperNode {
    std::vector<Range> children;
    std::array<uint32_t, kNodeWidth> upper{};    // index of the child's UpperNode, or kNoId
    std::array<uint32_t, kNodeWidth> subtree{};  // index of the child's task, or kNoId
};

class UpperTree {
  public:
    uint32_t grow(Builder& builder, const Range& range, uint32_t depth, uint64_t subtree_size) {
        const auto index = static_cast<uint32_t>(nodes.size());
        nodes.emplace_back();
        const std::vector<Range> children = builder.split_wide(range, depth);
        for (size_t i = 0; i < children.size(); ++i) {
            nodes[index].upper[i] = nodes[index].subtree[i] = kNoId;
            if (children[i].is_leaf || children[i].size() <= subtree_size ||
                depth + 1 >= kMaxAreaDepth) {
                nodes[index].subtree[i] = static_cast<uint32_t>(tasks.size());
                tasks.push_back({children[i], depth + 1, {}, 0});
            } else {
                const uint32_t child = grow(builder, children[i], depth + 1, subtree_size);
                nodes[index].upper[i] = child;
            }
        }
        nodes[index].children = children;
        return index;
    }

    struct Task {
        Range range;
        uint32_t depth = 0;
        Tree tree;
        uint32_t root = 0;
    };

    std::vector<UpperNode> nodes;
    std::vector<Task> tasks;
};

uint32_t shifted(uint32_t ref, const Tree& base) {
    if (!ChildRef::is_leaf(ref)) return ChildRef::inner(ref + base.nodes.size());
    const bool objects = ChildRef::is_objects(ref);
    const uint64_t offset = objects ? base.objects.size() : base.blocks.size();
    TALBOT_CHECK(ChildRef::first(ref) + offset <= ChildRef::kIndexMask);
    return ChildRef::leaf(ChildRef::first(ref) + offset, ChildRef::count(ref), objects);
}

// Room for `more` elements; where there is none, for an eighth more than there are, as what is
// never used of it would be most of a large array's memory while it is built.
template <class T>
void make_room(HugePageVector<T>& array, size_t more) {
    const size_t wanted = array.size() + more;
    if (wanted > array.capacity()) array.reserve(std::max(wanted, array.size() + array.size() / 8));
}

// Appends a task's tree and returns the reference to its root.
uint32_t append(Tree& tree, UpperTree::Task& task) {
    const uint32_t root = shifted(task.root, tree);
    for (WideNode& node : task.tree.nodes) {
        for (uint32_t& child : node.child) {
            if (child != kUnusedChild) child = shifted(child, tree);
        }
    }
    make_room(tree.nodes, task.tree.nodes.size());
    make_room(tree.blocks, task.tree.blocks.size());
    tree.nodes.insert(tree.nodes.end(), task.tree.nodes.begin(), task.tree.nodes.end());
    tree.blocks.insert(tree.blocks.end(), task.tree.blocks.begin(), task.tree.blocks.end());
    tree.objects.insert(tree.objects.end(), task.tree.objects.begin(), task.tree.objects.end());
    tree.depth = std::max(tree.depth, task.tree.depth);
    tree.references += task.tree.references;
    if (task.tree.crowd > tree.crowd) {
        tree.crowd = task.tree.crowd;
        tree.crowd_number = task.tree.crowd_number;
    }
    task.tree = {};
    return root;
}

// Takes the trees of finished tasks, in the order of the tasks, while later ones are still built:
// few of them are there at a time beside the whole.
class Joiner {
  public:
    Joiner(UpperTree& upper, uint64_t primitives, Tree& tree)
        : upper_(upper), tree_(tree), is_done_(upper.tasks.size(), false) {
        tree.nodes.reserve(upper.nodes.size() + primitives / kPrimitivesPerNode);
        tree.blocks.reserve(primitives * kBlocksPerPrimitive.first / kBlocksPerPrimitive.second);
        tree.nodes.resize(upper.nodes.size());
    }

    void finish(size_t task) {
        const std::lock_guard<std::mutex> lock(mutex_);
        is_done_[task] = true;
        while (roots_.size() < is_done_.size() && is_done_[roots_.size()])
            roots_.push_back(append(tree_, upper_.tasks[roots_.size()]));
    }

    // After the last task.
    void fill_upper_nodes() {
        for (size_t i = 0; i < upper_.nodes.size(); ++i) {
            const UpperNode& node = upper_.nodes[i];
            std::array<uint32_t, kNodeWidth> refs{};
            for (size_t k = 0; k < node.children.size(); ++k) {
                refs[k] = node.upper[k] != kNoId ? ChildRef::inner(node.upper[k])
                                                 : roots_[node.subtree[k]];
            }
            Builder::fill_node(tree_.nodes[i], node.children, refs);
        }
    }

  private:
    // What most trees have: memory that is not touched costs nothing.
    static constexpr uint64_t kPrimitivesPerNode = 14;
    static constexpr std::pair<uint64_t, uint64_t> kBlocksPerPrimitive = {2, 7};

    UpperTree& upper_;
    Tree& tree_;
    std::mutex mutex_;
    std::vector<bool> is_done_;
    std::vector<uint32_t> roots_;
};

}  // namespace

bool build_tree(HugePageVector<BuildPrimitive>& primitives, BuildQuality quality,
                const LoadTriangle& load, WorkerPool* pool, std::stop_token stop,
                const std::function<void(uint64_t)>& progress, Tree& tree) {
    tree = {};
    if (primitives.empty()) return true;
    const uint64_t count = primitives.size();
    const uint64_t room = places_for(count, quality) - count;
    primitives.resize(count + room);
    Builder upper_builder(primitives, quality, load, pool, stop);
    const Range whole = upper_builder.whole(count, room);
    Builder builder = upper_builder.without_pool();
    tree.is_empty = false;
    tree.triangles = count - whole.objects;
    tree.set_bounds(whole.box.lower, whole.box.upper);
    if (pool == nullptr || count <= kSubtreeSize || whole.is_leaf) {
        tree.root = builder.build(whole, 0, tree);
        tree.outgrows_cache = tree.bytes() > kCachedTreeBytes;
        if (progress) progress(count);
        return !stop.stop_requested();
    }
    UpperTree upper;
    upper.grow(upper_builder, whole, 0, std::max(kSubtreeSize, count / 64));
    Joiner joiner(upper, count, tree);
    std::atomic<uint64_t> done{0};
    pool->parallel_for(
        upper.tasks.size(),
        [&](uint64_t i, unsigned) {
            UpperTree::Task& task = upper.tasks[i];
            // Growing by doubling would hold, and touch, twice as much.
            task.tree.nodes.reserve(task.range.size() / 12 + 1);
            task.tree.blocks.reserve(task.range.size() / 3 + 1);
            task.root = builder.build(task.range, task.depth, task.tree);
            joiner.finish(i);
            const uint64_t now = done.fetch_add(task.range.size()) + task.range.size();
            if (progress) progress(std::min(now, count));
        },
        stop);
    if (stop.stop_requested()) return false;
    joiner.fill_upper_nodes();
    tree.depth = std::max(tree.depth, 1u);
    tree.root = ChildRef::inner(0);
    tree.outgrows_cache = tree.bytes() > kCachedTreeBytes;
    return true;
}

}  // namespace talbot
