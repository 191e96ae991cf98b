"""What each column means, and its symbol in the literature on ray shooting."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Term:
    """A column of the CSV files; `verified` is False where the symbol's definition could not be checked against its source."""

    name: str
    unit: str
    meaning: str
    symbol: str = ""
    verified: bool = True


GLOSSARY: dict[str, list[Term]] = {
    "Key columns": [
        Term("cell_id", "", "Identifies one measured configuration within a run; the same in every file."),
        Term("scene", "", "Generator with its size, or the scene's file."),
        Term("num_prims", "primitives", "Number of primitives: spheres, triangles, polygons, cones."),
        Term("needs", "", "What the scene has and the tracer is ready for: primitive kinds and features; all where it is ready for everything."),
        Term("rays", "", "Ray kind. Secondary rays start from the hits of the primary ones."),
        Term("phase", "", "What is timed: closest hit, any hit; of images the total, first_hit, shadow, reflection, refraction or shading (all the rest)."),
        Term("structure", "", "Acceleration structure."),
        Term("params", "", "Its parameters as they were used, defaults included."),
        Term("first_hit", "", "How primary hits are found: cast (rays) or zbuffer."),
        Term("occlusion", "", "none, or shadow_cache: the last blocker is tested first."),
        Term("max_depth", "", "Depth at which the tree of reflected and refracted rays ends; eye rays have depth 1."),
        Term("min_weight", "", "Rays that contribute less to the pixel are not traced (adaptive depth); 0 turns it off."),
        Term("isa", "", "Instruction set of the kernels."),
        Term("simd_width", "lanes", "Floats in one register of that instruction set."),
        Term("packet", "rays", "Rays that are traced together. With 1, rays go one by one: the only setting to compare with scalar literature."),
        Term("threads", "", "Threads that trace."),
    ],
    "summary.csv": [
        Term("n", "samples", "Timed samples behind the median."),
        Term("median_ns_per_ray", "ns", "Median time per ray.", "T_R divided by the rays"),
        Term("ci_lo, ci_hi", "ns", "95 % confidence interval of that median; free of assumptions on the distribution; empty below 6 samples."),
        Term("mad", "ns", "Median absolute deviation of the samples: their spread."),
        Term("mrays_per_s", "million rays / s", "Speed, 1000 / median_ns_per_ray."),
        Term("time_to_image_ms", "ms", "Build and one whole frame.", "T_B + T_R"),
        Term("ratio_vs_ref", "×", "Time divided by the reference technique's in the same round of samples; above 1 is slower."),
        Term("ratio_lo, ratio_hi", "×", "95 % confidence interval of that ratio."),
        Term("hit_mismatch", "rays", "Rays whose hit differs from the oracle's or the reference technique's. Must be 0."),
        Term("status", "", "ok; wrong (hits, therefore no timing); skipped (the machine lacks the ISA); timeout; failed; refused (parameters that do not suit the scene); unfinished (interrupted)."),
    ],
    "counters.csv": [
        Term("ray_count", "rays", "Rays over which was counted."),
        Term("node_visits", "", "Interior nodes opened or cells stepped into; per ray: node_visits_per_ray. The literature's traversal steps of a tree "
             "include the leaves: node_visits + leaf_visits.", "N_TS per ray of a grid"),
        Term("leaf_visits", "", "Leaves or elementary cells entered.", "N_ETS per ray"),
        Term("empty_leaf_visits", "", "Those of them that hold no primitive.", "N_EETS per ray"),
        Term("volume_tests", "", "Tests of a ray against a bounding volume.", "N_BIT per ray"),
        Term("prim_tests", "", "Tests of a ray against a primitive; per ray: prim_tests_per_ray.", "N_IT per ray"),
        Term("prim_hits", "", "Tests that found a hit within the ray's interval."),
        Term("cache_tests, cache_hits", "", "Tests of the cached blocker, and those that were blocked by it."),
        Term("rays_hit", "", "Rays that hit something; of any-hit rays, those that are blocked."),
        Term("cache_hit_rate", "", "Share of the rays that a cached blocker blocks."),
        Term("cache_hit_rate_blocked", "", "The same share of those rays that anything blocks."),
        Term("…_packets", "", "Times the code was reached, whatever the number of live lanes; the plain column sums over live lanes."),
        Term("simd_utilization", "", "Live lanes divided by all lanes of the operations performed: 1 is full use."),
        Term("first_prepare_ms", "ms", "Techniques that make cells on demand: prepare_ms of the first pass, which had all of them to make."),
        Term("cells, candidates_per_cell", "", "Cells made on demand that the pass used, and the primitives that one lists, mean."),
        Term("cell_bytes, full_table_bytes", "bytes", "Memory of all cells that are kept; and, extrapolated, if all rays that there are had cells like those of the pass."),
        Term("r_ITM", "", "Ray-primitive tests divided by the least number needed (one for each ray that hits): prim_tests / rays that hit.", "r_ITM", False),
    ],
    "frames.csv": [
        Term("rays_traced", "rays", "Rays of one frame; of samples.csv, of a pass."),
        Term("primary, reflection, refraction, shadow", "rays", "Those of a frame by kind."),
        Term("primary_hit, reflection_hit, refraction_hit, shadow_blocked", "rays", "Those of them that hit, or are blocked."),
        Term("tir", "", "Refractions that are totally reflected: the reflection ray carries their share."),
        Term("rays_saved", "rays", "Rays that the image has more which is cut nowhere (min_weight 0, same max_depth)."),
        Term("mean_depth", "", "Mean over the eye rays of the deepest ray that comes of each; an eye ray has depth 1."),
        Term("deepest", "", "Depth of the deepest ray."),
        Term("generations", "rays", "Eye, reflection and refraction rays of depth 1, 2, ..."),
        Term("error_mean, error_max", "radiance", "Absolute error of a pixel's channel against the image that is cut nowhere."),
        Term("bound_mean, bound_max", "radiance", "What was promised of it, pixel by pixel: over its cut rays, weight times the largest radiance a ray can carry."),
        Term("bound_exceeded", "pixels", "Pixels whose error is above their bound. Must be 0."),
    ],
    "builds.csv": [
        Term("build_ms", "ms", "Time to build the structure, the median of its builds.", "T_B"),
        Term("mprims_per_s", "million primitives / s", "Build speed."),
        Term("nodes", "", "All nodes or cells."),
        Term("interior_nodes", "", "Interior nodes.", "N_IN (N_G)"),
        Term("leaves", "", "Leaves or elementary cells; those that hold primitives are leaves - empty_leaves.", "N_V + N_EV (N_E)"),
        Term("empty_leaves", "", "Leaves without a primitive.", "N_EV (N_EE)"),
        Term("references", "", "References to primitives over all leaves.", "N_OIV (N_ER)"),
        Term("max_depth", "", "Depth of the tree, the root being 0."),
        Term("sah_cost", "", "Cost of a random line that meets the root by the surface area heuristic, by the volumes in use: half for each volume tested under a node, 1 a primitive."),
        Term("epo", "", "End-point overlap: cost of the nodes whose boxes hold a point of a surface without its primitive, mean over all surfaces."),
        Term("mem_bytes", "bytes", "Memory of the structure, without the scene."),
        Term("bytes_per_prim", "bytes", "Memory of structure and scene together per primitive."),
        Term("break_even_rays", "rays", "Rays from which on building and tracing cost less in all than the linear list without volumes in the same setting; or always, or never."),
        Term("scene_bytes", "bytes", "Memory of the scene alone."),
        Term("sibling_distance", "scene diagonals", "Nearness: mean distance of a node's children (the centres of their boxes) from their common centre."),
        Term("node_volume", "root volumes", "Mean over all nodes of what the volumes in use enclose."),
        Term("total_volume", "root volumes", "The same, the sum."),
        Term("cost_depth", "", "Mean depth of the SAH cost: nodes near the root are paid for by more rays."),
        Term("cost_depth_p90", "", "Depth down to which nine tenths of the SAH cost lie."),
        Term("epo_se", "", "Standard error of epo; 0 where no surface had to be sampled."),
        Term("volume_area", "", "Surface area of all bounding volumes together: of a hierarchy's nodes, of what a list puts one around."),
        Term("void_area", "", "Mean projected areas of the volumes of a list less those of the primitives in them; cones count with lids."),
        Term("builds", "", "Timed builds, measure.builds of the config."),
        Term("build_ci_lo, build_ci_hi", "ms", "95 % interval of build_ms, from 6 builds on."),
    ],
    "accuracy.csv": [
        Term("rays_checked", "rays", "Rays held against the exact oracle: all, or a seeded sample."),
        Term("false_miss", "rays", "The oracle hits, the technique misses."),
        Term("false_hit", "rays", "The technique hits, the oracle misses."),
        Term("wrong_prim", "rays", "Another primitive than the nearest one."),
        Term("self_hits", "rays", "Secondary rays that hit the surface they start from."),
        Term("t_ulp_p50, t_ulp_p99, t_ulp_max", "ulp", "Error of the distance t in units in the last place: median, 99th percentile, largest."),
        Term("cell_rays_checked", "rays", "Rays through grids whose cells were held against those that they exactly pass through (verify.cells)."),
        Term("cell_rays_missing, cells_missed", "", "Of them those that miss a cell in which they go some way, and all such cells."),
        Term("cell_rays_at_risk", "rays", "Those that go further in a missed cell than lists reach beyond cells. The robust forms have none."),
        Term("longest_missed", "cells", "Longest way of a ray in a cell that it misses."),
        Term("image_rmse, image_psnr, image_ssim", "", "Difference of the image from the reference technique's; equal images have PSNR ∞ dB."),
    ],
    "samples.csv": [
        Term("sample", "", "Number of the sample within its cell."),
        Term("order_index", "", "Place in the order in which the run took its samples."),
        Term("trace_ms", "ms", "Time of the sample."),
        Term("rays_traced", "rays", "Rays traced in the sample."),
        Term("ns_per_ray", "ns", "trace_ms / rays_traced."),
        Term("prepare_ms", "ms", "The part of trace_ms that sees the whole batch: sorting rays, and making what is made on demand and is not there yet."),
    ],
}
SYMBOL_NOTE = (
    "Symbols N_… and T_… follow Havran's tables of the Standard Procedural Databases; those in parentheses and r_ITM belong to a later list "
    "of minimum testing output whose definitions could not be checked against their source. Counts compare with that literature only at packet 1: "
    "in a packet a ray also visits what its neighbours visit."
)
