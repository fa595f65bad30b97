#pragma once

#include <string>
#include <vector>

/// The vector path: which of the machine's instruction sets the vector kernels use. Chosen at run time for
/// the whole process; results are the same on all of them.
namespace lambake {

/// The paths that this build has and this machine can run, best first, e.g. "AVX3", "AVX2", "SSE4".
std::vector<std::string> vector_paths();

/// The path in use.
std::string vector_path();

/// Uses one of vector_paths() from now on, for tests and benchmarks; an empty name is the best one. Not to be
/// called while kernels run. @throws InvalidOption for a path that is not there.
void choose_vector_path(const std::string& name);

}  // namespace lambake
