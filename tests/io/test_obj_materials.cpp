#include <gtest/gtest.h>

#include <string>

#include "io/mesh_folder.h"
#include "lambake/core/color.h"
#include "lambake/io/image_file.h"
#include "lambake/io/scene_file.h"

namespace lambake {
namespace {

class ObjMaterialsTest : public MeshFileTest {
 protected:
  /// An OBJ of one triangle, behind `lines`.
  SceneFile read_obj(const std::string& lines) {
    return read("a.obj", lines + "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  }
  /// The triangle's material, from a library with these lines.
  Material read_material(const std::string& lines) {
    write("a.mtl", "newmtl m\n" + lines);
    file_ = read_obj("mtllib a.mtl\nusemtl m\n");
    return material_of(file_);
  }
  static const Material& material_of(const SceneFile& file) {
    return file.scene.materials[file.scene.mesh.material_of(0)];
  }
  /// Of the file that read_material() read.
  std::size_t n_told(const std::string& code) const { return count_of(file_, code); }

 private:
  SceneFile file_;
};

constexpr LinearRgb black{0, 0, 0}, white{1, 1, 1}, red{1, 0, 0};

TEST_F(ObjMaterialsTest, NameInLatin1_BecomesUtf8) {
  write("a.mtl", "newmtl K\xF6rper\nKd 1 0 0\n");
  const SceneFile file =
      read("a.obj", "mtllib a.mtl\nusemtl K\xF6rper\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(file.scene.materials[file.scene.mesh.material_of(0)].name, "K\u00F6rper");
}

TEST_F(ObjMaterialsTest, DevicesThatAFileNames_AreNotRead) {
  const SceneFile file =
      read("a.obj", "mtllib /dev/zero\nmtllib /dev/zero\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(count_of(file, "missing_material_files"), 1u);
}

// Without normals nothing else says which edges are sharp.
TEST_F(ObjMaterialsTest, SmoothingThatIsNotRead_IsToldWhereThereAreNoNormals) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n", normal = "vn 0 0 1\n";
  const auto told = [&](const std::string& text) {
    const SceneFile file = read("s.obj", vertices + text);
    return std::make_pair(count_of(file, "flat_faces_not_kept"), count_of(file, "smoothing_groups_not_kept"));
  };
  EXPECT_EQ(told("f 1 2 3\ns off\nf 2 4 3\n"), std::make_pair(std::size_t{1}, std::size_t{0}));
  EXPECT_EQ(told("s 0\nf 1 2 3\nf 2 4 3\n"), std::make_pair(std::size_t{2}, std::size_t{0}));
  EXPECT_EQ(told("s 1\nf 1 2 3\ns 2\nf 2 4 3\n"), std::make_pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(told("s 1\nf 1 2 3\ns 1\nf 2 4 3\n"), std::make_pair(std::size_t{0}, std::size_t{0}));
  EXPECT_EQ(told(normal + "s off\nf 1//1 2//1 3//1\ns 2\nf 2//1 4//1 3//1\n"),
            std::make_pair(std::size_t{0}, std::size_t{0}));
}

TEST_F(ObjMaterialsTest, Keywords_MayBeOfAnyCase) {
  const Material material = read_material("kd 1 0 0\nKE 0 1 0\n");
  EXPECT_EQ(material.base_color, (LinearRgb{1, 0, 0}));
  EXPECT_EQ(material.emission, (LinearRgb{0, 1, 0}));
  write("a.mtl", "NEWMTL m\nMAP_KD missing.png\nTR 0.5\n");
  const SceneFile file = read("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  for (const char* code : {"unreadable_textures", "transparent_materials"})
    EXPECT_EQ(count_of(file, code), 1u) << code;
}

TEST_F(ObjMaterialsTest, Diffuse_BecomesBaseColorByFace) {
  write("a.mtl", "newmtl red one\nKd 1 0 0\nmap_Kd -s 1 1 missing.png\nnewmtl grey\nKd 0.5 0.5 0.5\n");
  const SceneFile file = read("a.obj",
                              "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red one\nf 1 2 3\n"
                              "usemtl grey\nf 1 2 3\nusemtl none\nf 1 2 3\n");
  const Scene& scene = file.scene;
  ASSERT_EQ(scene.mesh.n_triangles(), 4u);
  const auto color = [&](std::size_t t) { return scene.materials[scene.mesh.material_of(t)].base_color; };
  EXPECT_EQ(color(0), (LinearRgb{1, 1, 1}));
  EXPECT_EQ(color(1), (LinearRgb{1, 0, 0}));
  EXPECT_NEAR(color(2).g, 0.2140f, 1e-4f);  // sRGB 0.5.
  EXPECT_EQ(color(3), (LinearRgb{1, 1, 1}));
  EXPECT_EQ(count_of(file, "unknown_materials"), 1u);
  EXPECT_EQ(count_of(file, "unreadable_textures"), 1u);
  EXPECT_EQ(count_of(file, "texture_options"), 1u);
  // Faces of different material share no vertex.
  EXPECT_EQ(scene.mesh.n_vertices(), 12u);
}

TEST_F(ObjMaterialsTest, Emission_IsDecodedFromSrgb_AboveOneToo) {
  const LinearRgb emission = read_material("Ke 0.5 0 1.5\n").emission;
  EXPECT_FLOAT_EQ(emission.r, srgb_decode(0.5f));
  EXPECT_EQ(emission.g, 0);
  EXPECT_FLOAT_EQ(emission.b, srgb_decode(1.5f));
  EXPECT_EQ(read_material("Ke 1\n").emission, white);
  EXPECT_EQ(read_material("Kd 1 0 0\n").emission, black);
  for (const std::string odd : {"-1 0 0", "nan 0 0", "1e30 0 0"}) {
    EXPECT_EQ(read_material("Ke " + odd + "\n").emission, black) << odd;
    EXPECT_EQ(n_told("odd_emissions"), 1u) << odd;
  }
}

TEST_F(ObjMaterialsTest, EmissionTexture_MultipliesTheEmission) {
  std::filesystem::copy_file(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg", folder / "grey.jpg");
  const Material both = read_material("map_Kd grey.jpg\nKe 1 0 0\nmap_Ke -o +0.5 +0.5 0 grey.jpg\n");
  EXPECT_EQ(both.emission, red);
  EXPECT_NE(both.emission_texture, no_texture);
  EXPECT_EQ(both.emission_texture, both.base_color_texture);  // The image is read once.
  EXPECT_EQ(n_told("texture_options"), 1u);
  EXPECT_EQ(read_material("map_Ke grey.jpg\n").emission, white);
  EXPECT_EQ(read_material("Ke 0 0 0\nmap_Ke grey.jpg\n").emission, black);
  EXPECT_EQ(read_material("map_Ke missing.jpg\n").emission, black);
  EXPECT_EQ(n_told("unreadable_textures"), 1u);
}

TEST_F(ObjMaterialsTest, EmissionBehindABlackTexture_IsNone) {
  write_picture((folder / "black.png").string(), {2, 1, {{0, 0, 0}, {0, 0, 0}}});
  write_picture((folder / "spot.png").string(), {2, 1, {{0, 0, 0}, {0, 0, 1}}});
  EXPECT_EQ(read_material("Ke 1 0 0\nmap_Ke black.png\n").emission, black);
  EXPECT_EQ(read_material("Ke 1 0 0\nmap_Ke spot.png\n").emission, red);
}

// As where the texture cannot be read: white, and no emission.
TEST_F(ObjMaterialsTest, TexturesOfFacesWithoutTexcoords_AreNotUsed_AndTold) {
  std::filesystem::copy_file(LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg", folder / "grey.jpg");
  write("a.mtl", "newmtl m\nKd 1 0 0\nmap_Kd grey.jpg\nmap_Ke grey.jpg\nnewmtl n\nmap_Kd grey.jpg\n");
  const std::string quad = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const auto looks = [](const SceneFile& file, std::size_t triangle) {
    const Material& material = file.scene.materials[file.scene.mesh.material_of(triangle)];
    return std::pair(material.base_color_texture != no_texture, has_emission(material));
  };
  constexpr std::pair plain(false, false);
  const SceneFile none = read("a.obj", quad + "usemtl m\nf 1 2 3 4\nusemtl n\nf 1 2 3\n");
  EXPECT_EQ(looks(none, 0), plain);
  EXPECT_EQ(looks(none, 2), plain);
  EXPECT_EQ(none.scene.materials[none.scene.mesh.material_of(0)].base_color, red);
  EXPECT_EQ(count_of(none, "textures_without_texcoords"), 2u);
  EXPECT_EQ(count_of(none, "corners_without_texcoord"), 0u);
  // Others have some.
  const SceneFile one = read("b.obj", quad + "vt 0 1\nusemtl m\nf 1 2 3 4\nusemtl n\nf 1/1 2/1 3/1\n");
  EXPECT_EQ(looks(one, 0), plain);
  EXPECT_EQ(looks(one, 2), std::pair(true, false));
  EXPECT_EQ(count_of(one, "textures_without_texcoords"), 1u);
  EXPECT_EQ(count_of(one, "corners_without_texcoord"), 0u);
  // Others of the same material have some.
  const SceneFile mixed = read("c.obj", quad + "vt 0 1\nusemtl m\nf 1 2 3 4\nf 1/1 2/1 3/1\n");
  EXPECT_EQ(looks(mixed, 0), std::pair(true, true));
  EXPECT_EQ(count_of(mixed, "textures_without_texcoords"), 0u);
  EXPECT_EQ(count_of(mixed, "corners_without_texcoord"), 4u);
  // No texture looks them up.
  write("p.mtl", "newmtl plain\nKd 1 0 0\n");
  const std::string plain_quad = "mtllib p.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\nusemtl plain\n";
  EXPECT_EQ(count_of(read("d.obj", plain_quad + "f 1 2 3 4\nf 1/1 2/1 3/1\n"), "corners_without_texcoord"),
            0u);
}

TEST_F(ObjMaterialsTest, TransparencyOfEveryKind_IsToldOnceForEachMaterial) {
  for (const std::string line : {"d 0.5", "d -halo 0.5", "d 0", "Tr 0.5", "Tf 1 0.5 1", "Tf 0.5",
                                 "Tf xyz 1 1 1", "map_d a.png", "d 0.5\nTr 0.5"}) {
    read_material(line + "\n");
    EXPECT_EQ(n_told("transparent_materials"), 1u) << line;
  }
  for (const std::string line : {"d 1", "d -halo 1.0", "Tr 0", "Tr 1.000000", "Tf 1 1 1", "Tf 1"}) {
    read_material(line + "\n");
    EXPECT_EQ(n_told("transparent_materials"), 0u) << line;
  }
}

TEST_F(ObjMaterialsTest, ColorsThatAreNoRgb_AreToldOrRefused) {
  EXPECT_EQ(read_material("Kd spectral a.rfl 1\nKe xyz 1 1 1\n").base_color, white);
  EXPECT_EQ(n_told("unread_material_colors"), 2u);
  write("a.mtl", "newmtl m\nKd red\n");
  EXPECT_NE(refusal_of(write("a.obj", "mtllib a.mtl\nv 0 0 0\nf 1 1 1\n"))
                .find("a.mtl: line 2: expected three numbers after Kd, found \"red\""),
            std::string::npos);
}

TEST_F(ObjMaterialsTest, NamesThatBeginLikeAComment_AreNames) {
  write("a.mtl", "newmtl #ff0000\nKd 1 0 0\nnewmtl #0000ff\nKd 0 0 1\n");
  const SceneFile file = read_obj("mtllib a.mtl\nusemtl #ff0000\n");
  EXPECT_EQ(material_of(file).name, "#ff0000");
  EXPECT_EQ(material_of(file).base_color, red);
}

TEST_F(ObjMaterialsTest, LineOfSeveralLibraries_IsOneNameOnlyIfThatIsAFile) {
  write("a.mtl", "newmtl a\nKd 1 0 0\n");
  write("b.mtl", "newmtl b\nKd 1 0 0\n");
  write("b c.mtl", "newmtl c\nKd 1 0 0\n");
  EXPECT_EQ(material_of(read_obj("mtllib a.mtl  b.mtl\nusemtl b\n")).base_color, red);
  EXPECT_EQ(material_of(read_obj("mtllib b c.mtl\nusemtl c\n")).base_color, red);
  EXPECT_EQ(count_of(read_obj("mtllib a.mtl none.mtl\n"), "missing_material_files"), 1u);
  EXPECT_EQ(count_of(read_obj("mtllib such a file.mtl\n"), "missing_material_files"), 1u);
}

TEST_F(ObjMaterialsTest, LibraryWithAByteOrderMark_KeepsItsFirstMaterial) {
  write("a.mtl", "\xEF\xBB\xBFnewmtl m\nKd 1 0 0\n");
  EXPECT_EQ(material_of(read_obj("mtllib a.mtl\nusemtl m\n")).base_color, red);
}

TEST_F(ObjMaterialsTest, MaterialUsedBeforeItsLibraryIsNamed_IsThatOfTheLibrary) {
  write("a.mtl", "newmtl m\nKd 1 0 0\n");
  const SceneFile file = read("a.obj", "usemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nmtllib a.mtl\n");
  EXPECT_EQ(material_of(file).base_color, red);
  EXPECT_EQ(count_of(file, "unknown_materials"), 0u);
}

TEST_F(ObjMaterialsTest, LibraryNamedTwice_IsReadOnce) {
  write("a.mtl", "newmtl m\nmap_Kd -s 2 2 missing.png\n");
  const SceneFile file = read_obj("mtllib a.mtl\nmtllib a.mtl\nmtllib a.mtl a.mtl\nusemtl m\n");
  EXPECT_EQ(count_of(file, "texture_options"), 1u);
}

}  // namespace
}  // namespace lambake
