#pragma once

#include <GL/osmesa.h>

#include <cstdint>
#include <vector>

#include "lambake/scene/scene.h"

namespace lambake::bench {

/// A scene of point lights (k = 2) drawn by Mesa's llvmpipe, off screen, lit per fragment in a shader that is
/// written as one would: the measure of what a frame costs elsewhere.
class Llvmpipe {
 public:
  /// Uploads the mesh and compiles the shader. @throws std::runtime_error if Mesa cannot do it.
  Llvmpipe(const Scene& scene, const Camera& camera, std::uint32_t width, std::uint32_t height);
  ~Llvmpipe();
  Llvmpipe(const Llvmpipe&) = delete;
  Llvmpipe& operator=(const Llvmpipe&) = delete;

  /// Clears, draws and waits until the picture is done.
  void draw();

  /// RGBA of W×H, row by row from the bottom: 8 bits, linear, clamped.
  const std::vector<std::uint8_t>& pixels() const { return pixels_; }

 private:
  OSMesaContext context_ = nullptr;
  std::uint32_t n_indices_ = 0;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace lambake::bench
