#include <gtest/gtest.h>

#include <cmath>

#include "io/gltf_files.h"
#include "lambake/bake/bake.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

namespace lambake {
namespace {

TEST(ReadGltf, EveryRealFile_HasTheManifestsCounts_AndBakesWithoutNan) {
  for (const ManifestRow& row : gltf_rows()) {
    SCOPED_TRACE(row.path);
    SceneFile file;
    try {
      file = read_gltf_file(meshes_folder() + row.path, {});
    } catch (const InvalidScene& error) {
      EXPECT_EQ(row.n_faces, 0U) << error.what();
      continue;
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
      continue;
    }
    EXPECT_GT(row.n_faces, 0U);
    EXPECT_EQ(file.n_vertices, row.n_vertices);
    EXPECT_EQ(file.n_faces, row.n_faces);
    EXPECT_NO_THROW(check_mesh(file.scene.mesh, file.scene.materials.size()));
    file.scene.lights.emplace_back();
    const BakedColors baked = bake(file.scene, {});
    for (const LinearRgb& color : baked.colors) ASSERT_TRUE(is_finite(color));
  }
}

}  // namespace
}  // namespace lambake
