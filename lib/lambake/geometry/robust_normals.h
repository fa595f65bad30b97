#pragma once

#include "lambake/geometry/normals.h"
#include "lambake/scene/mesh.h"

namespace lambake {

/// Vertex normals that see all faces around as well as one direction can: the normal whose largest angle to
/// the normals of the faces is the smallest, whatever their areas and angles. It is the centre of the
/// smallest ball around them (CGAL), of radius 1 and with its centre at 0 if no direction sees all; such
/// vertices have no direction and are counted. Groups and defects as in vertex_normals().
///
/// A weighted mean has a direction wherever this has one: if n·v > 0 for all faces, so is Σ w n·v.
/// Source: Aubry & Löhner, On the "most normal" normal, Commun. Numer. Meth. Engng 24, 2008.
VertexNormals robust_normals(const Mesh& mesh);

}  // namespace lambake
