#include <gtest/gtest.h>

#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
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

TEST(ReadGltf, APipe_IsReadToo) {
  const std::string path = temporary_file("pipe.glb");
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const std::string bytes = read_bytes(meshes_folder() + "gltf/box01.glb");
  std::thread writer([&] { std::ofstream(path, std::ios::binary) << bytes; });
  const SceneFile file = read_gltf_file(path, {});
  writer.join();
  std::filesystem::remove(path);
  EXPECT_EQ(file.n_faces, 12U);
}

TEST(ReadGltf, AFolder_IsNamedAsOne) {
  try {
    read_gltf_file(meshes_folder(), {});
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), meshes_folder() + ": expected a file, found a folder");
  }
}

}  // namespace
}  // namespace lambake
