#include "experiments/record/metrics.h"

#include <array>

namespace raymeter {

namespace {

constexpr std::array<std::string_view, 16> kKeyColumns{"cell_id",   "scene",     "num_prims", "needs",      "rays", "phase",      "structure", "params",
                                                       "first_hit", "occlusion", "max_depth", "min_weight", "isa",  "simd_width", "packet",    "threads"};

using enum Better;

// Names in capitals are the symbols of the ray-shooting literature.
constexpr std::array kMetrics{
    Metric{Table::samples, "sample", neither, "number of the timed pass, from 0"},
    Metric{Table::samples, "order_index", neither, "place in the order in which the run took its samples"},
    Metric{Table::samples, "trace_ms", lower, "time of the pass: prepare and trace, without making rays; of images a whole frame, or one phase of it"},
    Metric{Table::samples, "rays_traced", exact, "rays of the pass"},
    Metric{Table::samples, "mrays_per_s", higher, "million rays per second"},
    Metric{Table::samples, "ns_per_ray", lower, "trace_ms / rays_traced; shading is shared out among all rays of the frame"},
    Metric{Table::samples, "status", neither, "ok, or wrong where the pass gave other hits than the verified ones"},
    Metric{Table::samples, "prepare_ms", lower, "the part of trace_ms that sees the whole batch: where structures are made on demand, what still had to be"},

    Metric{Table::builds, "build_ms", lower, "time to build the structure from the scene, the median of its builds (T_B)"},
    Metric{Table::builds, "mprims_per_s", higher, "million primitives built per second"},
    Metric{Table::builds, "nodes", exact, "interior nodes and leaves"},
    Metric{Table::builds, "interior_nodes", exact, "nodes with children"},
    Metric{Table::builds, "leaves", exact, "leaves; the cells of a grid"},
    Metric{Table::builds, "empty_leaves", exact, "leaves without a primitive"},
    Metric{Table::builds, "references", exact, "primitive references over all leaves"},
    Metric{Table::builds, "max_depth", exact, "of the deepest leaf, the root being 0 (the structure's; the cell's is among the key columns)"},
    Metric{Table::builds, "sah_cost", lower,
           "of a random line that meets the root, by the volumes in use: half for each volume tested under a node (1 for two), 1 a primitive; list: all "
           "primitives"},
    Metric{Table::builds, "epo", lower,
           "end-point overlap: what the nodes cost (as in sah_cost) whose boxes, whatever the volume in use, hold a surface's point without its primitive, on "
           "average"},
    Metric{Table::builds, "mem_bytes", lower, "of the structure alone"},
    Metric{Table::builds, "bytes_per_prim", lower, "of the structure and the scene together, per primitive"},
    Metric{Table::builds, "break_even_rays", lower,

           "rays from which on building and tracing cost less in all than with list:volume=none in the same setting; always or never where there is no such "
           "number"},
    Metric{Table::builds, "scene_bytes", lower, "of the scene alone"},
    Metric{Table::builds, "sibling_distance", lower,
           "mean distance of children's boxes' centres, whatever the volume in use, from their common centre, relative to the scene's diagonal"},
    Metric{Table::builds, "node_volume", lower, "mean over all nodes of what their volumes in use enclose, relative to the root's"},
    Metric{Table::builds, "total_volume", lower, "the same, the sum"},
    Metric{Table::builds, "cost_depth", neither, "mean depth of the SAH cost, by the volumes in use: what nodes near the root cost matters to more rays"},
    Metric{Table::builds, "cost_depth_p90", neither, "depth down to which nine tenths of the SAH cost lie"},
    Metric{Table::builds, "epo_se", neither, "standard error of epo; 0 where no surface had to be sampled"},
    Metric{Table::builds, "volume_area", lower, "surface area of all bounding volumes together: of nodes, or of what a list puts one around"},
    Metric{Table::builds, "void_area", lower, "lists: mean projected areas of the volumes less those of the primitives in them"},
    Metric{Table::builds, "builds", neither, "timed builds (measure.builds)"},
    Metric{Table::builds, "build_ci_lo", lower, "95 % interval of build_ms, from 6 builds on"},
    Metric{Table::builds, "build_ci_hi", lower, "its upper end"},

    Metric{Table::counters, "ray_count", exact, "rays of the pass"},
    Metric{Table::counters, "node_visits", exact, "interior nodes opened, cells stepped into"},
    Metric{Table::counters, "leaf_visits", exact, "leaves (elementary cells) entered"},
    Metric{Table::counters, "empty_leaf_visits", exact, "those that hold no primitive"},
    Metric{Table::counters, "volume_tests", exact, "tests of a ray against a bounding volume"},
    Metric{Table::counters, "prim_tests", exact, "tests of a ray against a primitive"},
    Metric{Table::counters, "prim_hits", exact, "those that found a hit inside the ray's interval"},
    Metric{Table::counters, "cache_tests", exact, "tests of a cached blocker"},
    Metric{Table::counters, "cache_hits", exact, "those that block"},
    Metric{Table::counters, "node_visits_packets", exact, "times a register-wide node visit was executed"},
    Metric{Table::counters, "leaf_visits_packets", exact, "likewise"},
    Metric{Table::counters, "empty_leaf_visits_packets", exact, "likewise"},
    Metric{Table::counters, "volume_tests_packets", exact, "likewise"},
    Metric{Table::counters, "prim_tests_packets", exact, "likewise: the cost that SIMD really pays"},
    Metric{Table::counters, "prim_hits_packets", exact, "likewise"},
    Metric{Table::counters, "cache_tests_packets", exact, "likewise"},
    Metric{Table::counters, "cache_hits_packets", exact, "likewise"},
    Metric{Table::counters, "node_visits_per_ray", lower, "node_visits / ray_count (N_TS, where nodes are all that is traversed)"},
    Metric{Table::counters, "prim_tests_per_ray", lower, "prim_tests / ray_count (N_IT, with packet 1)"},
    Metric{Table::counters, "simd_utilization", higher, "live lanes / executed lanes over node visits, volume and primitive tests"},
    Metric{Table::counters, "rays_hit", exact, "rays that hit something; of any-hit rays, those that are blocked"},
    Metric{Table::counters, "cache_hit_rate", higher, "cache_hits / ray_count"},
    Metric{Table::counters, "cache_hit_rate_blocked", higher, "cache_hits / rays_hit: how many of the blocked rays the cache answers"},
    Metric{Table::counters, "first_prepare_ms", lower, "techniques that make cells on demand: prepare_ms of the first pass, which had all of them to make"},
    Metric{Table::counters, "cells", exact, "cells that the pass used, made on demand"},
    Metric{Table::counters, "candidates_per_cell", exact, "primitives in their lists, mean"},
    Metric{Table::counters, "cell_bytes", exact, "memory of all cells that are kept"},
    Metric{Table::counters, "full_table_bytes", neither, "extrapolated: of the cells, if all rays that there are had some like those of the pass"},

    Metric{Table::accuracy, "rays_checked", neither, "rays held against the exact oracle"},
    Metric{Table::accuracy, "false_miss", exact, "hits that were missed"},
    Metric{Table::accuracy, "false_hit", exact, "hits where there is nothing"},
    Metric{Table::accuracy, "wrong_prim", exact, "hits of a primitive that is not the nearest"},
    Metric{Table::accuracy, "self_hits", exact, "secondary rays that hit the surface they start from"},
    Metric{Table::accuracy, "t_ulp_p50", lower, "distance's error in units in the last place, median"},
    Metric{Table::accuracy, "t_ulp_p99", lower, "the same, 99th percentile"},
    Metric{Table::accuracy, "t_ulp_max", lower, "the same, largest"},
    Metric{Table::accuracy, "image_rmse", lower,
           "of images, against the reference technique's that is cut nowhere (min_weight 0): root of the mean squared difference of radiance"},
    Metric{Table::accuracy, "image_psnr", higher, "likewise, in decibels, white being the peak; inf where the images are equal"},
    Metric{Table::accuracy, "image_ssim", higher, "likewise, as shown (Wang et al. 2004); empty where a side is below 11 pixels"},
    Metric{Table::accuracy, "cell_rays_checked", neither, "verify.cells: rays that walk through cells whose walk was held against the exact one"},
    Metric{Table::accuracy, "cell_rays_missing", lower, "of them those that do not visit every cell in which they go some way"},
    Metric{Table::accuracy, "cell_rays_at_risk", exact, "that go further in such a cell than lists reach beyond cells, so that a hit there may be lost"},
    Metric{Table::accuracy, "cells_missed", lower, "such cells, of all those rays"},
    Metric{Table::accuracy, "longest_missed", lower, "longest way of a ray in a cell that it misses, of all axes the largest, in cells"},

    Metric{Table::frames, "rays_traced", exact, "rays of a frame: eye, reflection, refraction and shadow rays"},
    Metric{Table::frames, "primary", exact, "eye rays"},
    Metric{Table::frames, "primary_hit", exact, "those that hit"},
    Metric{Table::frames, "reflection", exact, "reflection rays, those for total reflection among them"},
    Metric{Table::frames, "reflection_hit", exact, "those that hit"},
    Metric{Table::frames, "refraction", exact, "refraction rays"},
    Metric{Table::frames, "refraction_hit", exact, "those that hit"},
    Metric{Table::frames, "tir", exact, "refractions that are totally reflected"},
    Metric{Table::frames, "shadow", exact, "shadow rays"},
    Metric{Table::frames, "shadow_blocked", exact, "those that are blocked"},
    Metric{Table::frames, "rays_saved", higher, "rays that the image which is cut nowhere has more"},
    Metric{Table::frames, "mean_depth", lower, "mean over the eye rays of the deepest ray that comes of each"},
    Metric{Table::frames, "deepest", exact, "depth of the deepest ray"},
    Metric{Table::frames, "generations", exact, "eye, reflection and refraction rays of depth 1, 2, ..."},
    Metric{Table::frames, "error_mean", lower, "mean absolute error of a pixel's channel against the image that is cut nowhere"},
    Metric{Table::frames, "error_max", lower, "the largest"},
    Metric{Table::frames, "bound_mean", lower,
           "mean of what was promised of it: over the rays that were cut off, weight x largest radiance that a ray can carry"},
    Metric{Table::frames, "bound_max", lower, "the largest"},
    Metric{Table::frames, "bound_exceeded", exact, "pixels whose error is above their bound"},

    Metric{Table::summary, "n", neither, "timed passes"},
    Metric{Table::summary, "median_ns_per_ray", lower, "median over the passes"},
    Metric{Table::summary, "ci_lo", neither, "distribution-free 95 % interval of that median, lower end; empty below 6 passes"},
    Metric{Table::summary, "ci_hi", neither, "upper end"},
    Metric{Table::summary, "mad", lower, "median absolute deviation of ns_per_ray, unscaled"},
    Metric{Table::summary, "mrays_per_s", higher, "1000 / median_ns_per_ray"},
    Metric{Table::summary, "build_ms", lower, "as in builds (T_B)"},
    Metric{Table::summary, "time_to_image_ms", lower, "build and one whole frame"},
    Metric{Table::summary, "mem_bytes", lower, "as in builds"},
    Metric{Table::summary, "node_visits_per_ray", lower, "as in counters"},
    Metric{Table::summary, "prim_tests_per_ray", lower, "as in counters (N_IT)"},
    Metric{Table::summary, "simd_utilization", higher, "as in counters"},
    Metric{Table::summary, "ratio_vs_ref", lower, "time against the reference cell's: median over the passes that ran side by side"},
    Metric{Table::summary, "ratio_lo", neither, "distribution-free 95 % interval of that median, lower end"},
    Metric{Table::summary, "ratio_hi", neither, "upper end"},
    Metric{Table::summary, "hit_mismatch", exact, "rays whose hit, or pixels whose colour, differ from the reference technique's or from the oracle"},
    Metric{Table::summary, "status", neither, "ok, wrong, skipped, timeout, failed, refused (parameters that do not suit the scene) or unfinished"},

    Metric{Table::break_even, "against", neither, "cell_id of another technique in the same scene, rays and setting"},
    Metric{Table::break_even, "break_even_rays", lower, "as in builds, against that one"},
};

}  // namespace

std::string_view name(Table table) noexcept {
  constexpr std::array<std::string_view, 7> names{"samples", "builds", "counters", "accuracy", "frames", "summary", "break_even"};
  return names[static_cast<std::size_t>(table)];
}

std::string_view name(Better better) noexcept {
  constexpr std::array<std::string_view, 4> names{"lower", "higher", "exact", "-"};
  return names[static_cast<std::size_t>(better)];
}

std::span<const Metric> metrics() noexcept { return kMetrics; }
std::span<const std::string_view> key_columns() noexcept { return kKeyColumns; }

std::vector<std::string_view> columns(Table table) {
  std::vector<std::string_view> names(kKeyColumns.begin(), table == Table::break_even ? kKeyColumns.begin() + 1 : kKeyColumns.end());
  for (const Metric& metric : kMetrics) {
    if (metric.table == table) names.push_back(metric.name);
  }
  return names;
}

}  // namespace raymeter
