#pragma once

#include <glm/glm.hpp>

namespace lambake {

/// The distance of the triangle a b c from the origin.
double distance_from_origin(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

}  // namespace lambake
