#pragma once

#include <array>
#include <cstddef>

/// The arithmetic of the inverse-square lamp and nothing else: the sum of `n_lights` lamps (six numbers each:
/// position, intensity) at n points, one array per number. Compiled for the machine at hand, vectorised by
/// the compiler.
void bare_loop(std::array<const float*, 3> positions, std::array<const float*, 3> normals,
               std::array<float*, 3> out, std::size_t n, const float* lights, std::size_t n_lights);
