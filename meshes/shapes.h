#pragma once

#include <cstdint>

#include "lambake/scene/mesh.h"

/// Shapes whose light is known or whose trouble is known, for the models of this folder and for the tests.
/// Triangles wind counter-clockwise seen from outside (from above for open ones); y is up. Vertices are
/// shared: no seams, unless said otherwise. Computed in double, stored in float.
namespace lambake {

/// Sphere of radius 1: an icosahedron whose triangles are cut in four `level` times. 10·4^level + 2 vertices,
/// 20·4^level triangles; the vertices of a level come first in the next one.
Mesh icosphere(unsigned level);

/// Sphere of radius 1 with poles on y: `n_rings` >= 2 bands of latitude, `n_segments` >= 3 of longitude.
/// 2 + (n_rings − 1)·n_segments vertices, with their exact normals.
Mesh uv_sphere(unsigned n_rings, unsigned n_segments);

/// Tube of radius `tube_radius` around the (2,3) torus knot on a torus of radii 1 and 0.45.
/// n_along·n_around vertices, with the exact normals of the tube and colours that go once around the wheel.
Mesh torus_knot(unsigned n_along, unsigned n_around, float tube_radius);

/// The cube [−1,1]³: 8 vertices, 12 triangles. Bit i of `split` in [0,64) picks the diagonal that cuts side i
/// (−x, +x, −y, +y, −z, +z).
Mesh cube(unsigned split);

/// A box of half size (1.2, 0.7, 0.8) whose four upright edges are rounded with radius 0.3 in `n_arc` flat
/// strips, closed by flat lids: a crease of 90° around each lid, smooth elsewhere. 8·(n_arc + 1) + 2
/// vertices.
Mesh rounded_box(unsigned n_arc);

/// The square |x|, |z| <= half_side at y = 0, facing up, as n×n quads of two triangles: (n + 1)² vertices in
/// rows along x, with texture coordinates. `n` = 1 is the big quad.
Mesh grid(unsigned n, float half_side);

/// A grid() of half side 1 with gentle hills (sums of waves): (n + 1)² vertices.
Mesh height_field(unsigned n);

/// A Möbius band of radius 1 and width 0.6: one side only, so no winding is consistent. 2·n vertices,
/// 2·n triangles; exactly one crosswise edge is run through twice in one direction.
Mesh moebius_band(unsigned n);

}  // namespace lambake
