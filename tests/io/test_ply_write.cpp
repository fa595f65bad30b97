#include "lambake/io/ply_write.h"
#include "lambake/io/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "lambake/core/error.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

class PlyWrite : public testing::Test {
 protected:
  PlyWrite() {
    scene.materials.emplace_back();
    Mesh& mesh = scene.mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0.25f}, {0, 1, -3e20f}, {1e-30f, 1, 1}};
    mesh.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, -1}};
    mesh.texcoords[0] = {{0, 0}, {1, 0.25f}, {0.5f, 1}, {2, -1}};
    mesh.opacities = {1, 0.5f, 0, 1};
    scene.materials[0].alpha_mode = AlphaMode::blend;
    mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
    baked.colors = {{0, 0.5f, 1}, {0.18f, 0.002f, 0.9f}, {0.25f, 0.75f, 0.1f}, {1, 1, 1}};
  }
  ~PlyWrite() override { std::filesystem::remove(path); }

  Mesh write_and_read(const PlyWriteOptions& options = {}) {
    written = write_ply_file(path, scene, baked, options);
    return read_scene_file(path).scene.mesh;
  }

  Scene scene;
  BakedColors baked;
  WrittenColors written;
  std::string path = testing::TempDir() + "lambake_" +
                     testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply";
};

TEST_F(PlyWrite, ReadAgain_IsTheSameMesh) {
  const Mesh mesh = write_and_read();
  EXPECT_EQ(mesh.positions, scene.mesh.positions);
  EXPECT_EQ(mesh.normals, scene.mesh.normals);
  EXPECT_EQ(mesh.texcoords[0], scene.mesh.texcoords[0]);
  EXPECT_EQ(mesh.triangles, scene.mesh.triangles);
  ASSERT_EQ(mesh.colors.size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_EQ(to_srgb8(mesh.colors[v]), to_srgb8(baked.colors[v]));
  ASSERT_EQ(mesh.opacities.size(), 4u);
  EXPECT_NEAR(mesh.opacities[1], 0.5f, 1.0f / 255);
  EXPECT_EQ(written.clipped_vertices, 0u);
}

TEST_F(PlyWrite, FloatColors_ComeBackToTheBitAndUnclamped) {
  baked.colors[0] = {0.001f, 4, 1e-9f};
  const Mesh mesh = write_and_read({.color = ColorStorage::f32});
  EXPECT_EQ(mesh.colors, baked.colors);
  EXPECT_EQ(mesh.opacities, scene.mesh.opacities);
  EXPECT_EQ(written.clipped_vertices, 0u);
  scene.mesh.opacities = {1, 1, 1, 1};
  EXPECT_TRUE(write_and_read({.color = ColorStorage::f32}).opacities.empty());
}

TEST_F(PlyWrite, ColorsAboveOne_AreCounted) {
  for (const auto& [brightest, stops] :
       {std::pair{1.01f, "by 1 stop "}, {2.0f, "by 1 stop "}, {2.5f, "by 2 stops "}, {4.1f, "by 3 stops "}}) {
    baked.colors[3] = {1, brightest, 1};
    write_and_read();
    EXPECT_EQ(written.clipped_vertices, 1u);
    ASSERT_EQ(written.findings.size(), 1u);
    EXPECT_EQ(written.findings[0].code, "clipped_vertices");
    EXPECT_NE(written.findings[0].text.find(stops), std::string::npos) << written.findings[0].text;
  }
}

TEST_F(PlyWrite, ColorsBelowZero_AreTold) {
  baked.colors[3] = {1, -0.01f, 1};
  write_and_read();
  ASSERT_EQ(written.findings.size(), 1u);
  EXPECT_EQ(written.findings[0].code, "negative_vertices");
}

TEST_F(PlyWrite, OpacityOfTheMaterial_IsInTheAlpha) {
  scene.materials[0].opacity = 0.5f;
  const Mesh mesh = write_and_read();
  ASSERT_EQ(mesh.opacities.size(), 4u);
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_NEAR(mesh.opacities[v], 0.5f * scene.mesh.opacities[v], 1.0f / 255) << v;
}

TEST_F(PlyWrite, OpacityOfAnOpaqueMaterial_IsOne_AndOfAMaskedOneNothingBetween) {
  scene.materials[0].alpha_mode = AlphaMode::opaque;
  EXPECT_EQ(write_and_read().opacities, (std::vector<float>{1, 1, 1, 1}));
  scene.materials[0].alpha_mode = AlphaMode::mask;
  EXPECT_EQ(write_and_read().opacities, (std::vector<float>{1, 1, 0, 1}));
  scene.materials[0].alpha_cutoff = 0.75f;
  EXPECT_EQ(write_and_read().opacities, (std::vector<float>{1, 0, 0, 1}));
}

TEST_F(PlyWrite, ColorsOfAnotherMesh_AreRefused) {
  baked.colors.pop_back();
  EXPECT_THROW(write_ply_file(path, scene, baked, {}), InvalidScene);
}

TEST_F(PlyWrite, MaterialAndEmission_AreInTheColor) {
  scene.materials[0].base_color = {0.5f, 0.25f, 1};
  scene.materials[0].emission = {0, 0, 0.125f};
  const Mesh mesh = write_and_read({.color = ColorStorage::f32});
  EXPECT_EQ(mesh.colors[0], (LinearRgb{0, 0.125f, 1.125f}));
}

TEST_F(PlyWrite, UnlitMaterial_ShowsNoEmission) {
  scene.materials[0].emission = {0, 0, 0.125f};
  scene.materials[0].is_unlit = true;
  EXPECT_EQ(write_and_read({.color = ColorStorage::f32}).colors, baked.colors);
}

TEST_F(PlyWrite, Texture_IsSampledAtTheVertex) {
  Image image;
  image.width = image.height = 1;
  image.pixels = {{0.5f, 0.25f, 0, 1}};
  scene.images = {image};
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture = 0;
  const Mesh mesh = write_and_read({.color = ColorStorage::f32});
  EXPECT_EQ(mesh.colors[3], (LinearRgb{0.5f, 0.25f, 0}));
  ASSERT_EQ(written.findings.size(), 1U);
  EXPECT_EQ(written.findings[0].code, "textures_not_written");
  EXPECT_EQ(written.findings[0].count, 1U);
}

TEST_F(PlyWrite, PositionsThatAreNotFinite_StayAndColorsThatAreNot_BecomeBlack) {
  scene.mesh.positions[3] = {NAN, INFINITY, 0};
  baked.colors[3] = {NAN, 1, 1};
  const Mesh mesh = write_and_read();
  EXPECT_TRUE(std::isnan(mesh.positions[3].x));
  EXPECT_TRUE(std::isinf(mesh.positions[3].y));
  EXPECT_EQ(mesh.colors[3], LinearRgb{});
  ASSERT_EQ(written.findings.size(), 1u);
  EXPECT_EQ(written.findings[0].count, 1u);
}

TEST_F(PlyWrite, FolderThatIsNotThere_ThrowsAndLeavesNothing) {
  EXPECT_THROW(write_ply_file(testing::TempDir() + "lambake_no_folder/x.ply", scene, baked, {}), IoError);
  EXPECT_THROW(write_ply_file(path, scene, baked, {.color = ColorStorage::u16}), InvalidOption);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(PlyWrite, ColoursAndNumbersOfFaces_AreRead_AsOthersWriteThem) {
  const std::vector<Srgb8> colors = {{255, 0, 7}, {1, 2, 3}};
  const std::vector<float> quality = {-0.5f, 1e20f};
  write_face_ply(path, scene.mesh, colors, quality, "quality: of the faces");
  const Mesh mesh = read_scene_file(path).scene.mesh;
  EXPECT_EQ(mesh.n_triangles(), 2u);
  ASSERT_FALSE(mesh.colors.empty());
  for (std::size_t f = 0; f < 2; ++f)
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(to_srgb8(mesh.colors[mesh.triangles[f][c]]), colors[f]);
      EXPECT_EQ(mesh.positions[mesh.triangles[f][c]], scene.mesh.positions[scene.mesh.triangles[f][c]]);
    }
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(stream), {});
  EXPECT_NE(bytes.find("comment quality: of the faces\n"), std::string::npos);
  EXPECT_NE(bytes.find("property float quality\nend_header\n"), std::string::npos);
  // A face is a count, three indices, three bytes of colour and the number.
  float last = 0, first = 0;
  std::memcpy(&last, bytes.data() + bytes.size() - 4, 4);
  std::memcpy(&first, bytes.data() + bytes.size() - 20 - 4, 4);
  EXPECT_EQ(first, quality[0]);
  EXPECT_EQ(last, quality[1]);
}

}  // namespace
}  // namespace lambake
