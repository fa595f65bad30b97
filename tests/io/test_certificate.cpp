/// What is certified against what the written file shows. The file is taken apart here, and the light per
/// pixel computed here, so that neither side is what it is held against.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "lambake/bake/bake.h"
#include "lambake/io/gltf.h"
#include "lambake/io/ply_write.h"
#include "lambake/measure/select.h"
#include "measure/scenes.h"

namespace lambake {
namespace {

/// Vertices and triangles as a file has them, and what it shows at each vertex.
struct Shown {
  std::vector<glm::dvec3> positions, colors;
  std::vector<glm::uvec3> triangles;
};

/// Of a GLB of one primitive: base colour factor times COLOR_0, as an unlit material shows it.
Shown shown_by_glb(const std::string& path) {
  const Glb glb = read_glb(path);
  const auto& primitive = glb.primitive(0, 0);
  const auto& material = glb.json["materials"][primitive["material"].get<std::size_t>()];
  EXPECT_TRUE(material["extensions"].contains("KHR_materials_unlit"));
  glm::dvec3 factor(1);
  if (material["pbrMetallicRoughness"].contains("baseColorFactor"))
    for (int k = 0; k < 3; ++k)
      factor[k] = material["pbrMetallicRoughness"]["baseColorFactor"][static_cast<std::size_t>(k)];
  const std::size_t position = glb.attribute(0, 0, "POSITION"), color = glb.attribute(0, 0, "COLOR_0");
  const int type = glb.json["accessors"][color]["componentType"];
  Shown shown;
  for (std::size_t v = 0; v < glb.count(position); ++v) {
    glm::dvec3 p, c;
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(k);
      p[k] = glb.value<float>(position, v, at);
      c[k] = type == 5121   ? glb.value<std::uint8_t>(color, v, at) / 255.0
             : type == 5123 ? glb.value<std::uint16_t>(color, v, at) / 65535.0
                            : static_cast<double>(glb.value<float>(color, v, at));
    }
    shown.positions.push_back(p);
    shown.colors.push_back(factor * c);
  }
  const std::size_t indices = primitive["indices"];
  const bool is_short = glb.json["accessors"][indices]["componentType"] == 5123;
  for (std::size_t i = 0; i < glb.count(indices); i += 3) {
    glm::uvec3 t;
    for (std::size_t c = 0; c < 3; ++c)
      t[static_cast<int>(c)] = is_short ? glb.value<std::uint16_t>(indices, i + c, 0)
                                        : glb.value<std::uint32_t>(indices, i + c, 0);
    shown.triangles.push_back(t);
  }
  return shown;
}

/// Of a PLY with normals and without texture coordinates: bytes are decoded, floats are as they are.
Shown shown_by_ply(const std::string& path, std::size_t n_vertices, bool is_float) {
  const std::string bytes = read_bytes(path);
  const char* at = bytes.data() + bytes.find("end_header\n") + 11;
  const auto take = [&](auto& value) {
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
  };
  Shown shown;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    glm::vec3 position, normal, color;
    take(position), take(normal);
    if (is_float) {
      take(color);
    } else {
      std::array<std::uint8_t, 4> c{};
      take(c);
      for (int k = 0; k < 3; ++k)
        color[k] = srgb_decode(static_cast<float>(c[static_cast<std::size_t>(k)]) / 255);
    }
    shown.positions.emplace_back(position);
    shown.colors.emplace_back(color);
  }
  while (at < bytes.data() + bytes.size()) {
    std::uint8_t three = 0;
    glm::uvec3 t;
    take(three), take(t);
    shown.triangles.push_back(t);
  }
  return shown;
}

double on_screen(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

/// Light per pixel at a point of a triangle of the scene: its normal interpolated there; suns and lamps of
/// decay 2.
glm::dvec3 per_pixel(const Scene& scene, const glm::uvec3& t, const glm::dvec3& p) {
  const glm::dvec3 a(scene.mesh.positions[t[0]]), b(scene.mesh.positions[t[1]]),
      c(scene.mesh.positions[t[2]]);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double area = glm::dot(n, n);
  const double u = glm::dot(glm::cross(c - b, p - b), n) / area,
               v = glm::dot(glm::cross(a - c, p - c), n) / area;
  const glm::dvec3 normal =
      glm::normalize(u * glm::dvec3(scene.mesh.normals[t[0]]) + v * glm::dvec3(scene.mesh.normals[t[1]]) +
                     (1 - u - v) * glm::dvec3(scene.mesh.normals[t[2]]));
  glm::dvec3 light(0);
  for (const Light& l : scene.lights) {
    const bool is_sun = l.type == LightType::directional;
    const glm::dvec3 d = is_sun ? glm::dvec3(l.direction_to_light) : glm::dvec3(l.position) - p;
    const double falloff = is_sun ? 1 : 1 / glm::dot(d, d);
    light += std::max(0.0, glm::dot(normal, glm::normalize(d))) * falloff *
             glm::dvec3(l.intensity.r, l.intensity.g, l.intensity.b);
  }
  const LinearRgb &base = scene.materials[0].base_color, &emission = scene.materials[0].emission;
  return glm::dvec3(base.r, base.g, base.b) * light + glm::dvec3(emission.r, emission.g, emission.b);
}

/// The largest difference on screen between what a file shows and light per pixel, on a grid of each
/// triangle.
double largest_difference(const Scene& scene, const BakedColors& baked, const Shown& shown) {
  constexpr int n = 6;
  double largest = 0;
  EXPECT_EQ(shown.triangles.size(), mesh_of(scene, baked).n_triangles());
  for (std::size_t f = 0; f < shown.triangles.size(); ++f) {
    const glm::uvec3& t = shown.triangles[f];
    const glm::uvec3& whole = scene.mesh.triangles[baked.parent_triangles[f]];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double u = double(i) / n, v = double(j) / n, w = 1 - u - v;
        const glm::dvec3 p =
            u * shown.positions[t[0]] + v * shown.positions[t[1]] + w * shown.positions[t[2]];
        const glm::dvec3 g = u * shown.colors[t[0]] + v * shown.colors[t[1]] + w * shown.colors[t[2]];
        const glm::dvec3 f_p = per_pixel(scene, whole, p);
        for (int k = 0; k < 3; ++k)
          largest = std::max(largest, std::abs(on_screen(g[k]) - on_screen(f_p[k])));
      }
  }
  return largest;
}

/// An asset of one primitive, as another program would write it.
void write_asset(const std::string& path, const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  const Material& m = scene.materials[0];
  std::string bin;
  const auto append = [&](const auto& values) {
    bin.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  append(mesh.positions), append(mesh.normals), append(mesh.triangles);
  const std::size_t n = 12 * mesh.n_vertices(), n_indices = 3 * mesh.n_triangles();
  const nlohmann::json json = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"material", 0}}}}}}},
      {"materials",
       {{{"pbrMetallicRoughness", {{"baseColorFactor", {m.base_color.r, m.base_color.g, m.base_color.b, 1}}}},
         {"emissiveFactor", {m.emission.r, m.emission.g, m.emission.b}}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", mesh.n_vertices()},
         {"type", "VEC3"},
         {"min", {-1, -1, -1}},
         {"max", {1, 1, 1}}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", mesh.n_vertices()}, {"type", "VEC3"}},
        {{"bufferView", 2}, {"componentType", 5125}, {"count", n_indices}, {"type", "SCALAR"}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", n}},
        {{"buffer", 0}, {"byteOffset", n}, {"byteLength", n}},
        {{"buffer", 0}, {"byteOffset", 2 * n}, {"byteLength", 4 * n_indices}}}},
      {"buffers",
       {{{"byteLength", bin.size()}, {"uri", std::filesystem::path(path).stem().string() + ".bin"}}}}};
  write_bytes(std::filesystem::path(path).replace_extension(".bin").string(), bin);
  write_bytes(path, json.dump());
}

struct Finish {
  LinearRgb base, emission;
};

/// Emission that fits, that clips for some light and for all, in some channels, behind a dark and no base
/// colour.
const Finish finishes[] = {
    {{1, 1, 1}, {0, 0, 0}},
    {{0.5f, 0.25f, 0.8f}, {0, 0, 0}},
    {{0.2f, 0.2f, 0.2f}, {0.5f, 0.5f, 0.5f}},
    {{0.5f, 0.5f, 0.5f}, {0.01f, 0.002f, 0.05f}},
    {{1, 1, 1}, {0.3f, 0, 0.6f}},
    {{0.8f, 0.6f, 0.4f}, {0.05f, 0.3f, 0.39f}},
    {{0.001f, 0.01f, 0.1f}, {0, 0.0001f, 0.01f}},
    {{0, 0.5f, 1}, {0.0021f, 0, 0.01f}},
    {{0, 0, 0}, {0.9f, 0.13f, 0.0003f}},
    {{0.3f, 0.3f, 0.3f}, {0.9f, 1, 0.2f}},
};

enum class Format { new_glb, asset, ply };

std::size_t count_of(const Findings& findings, const std::string& code) {
  for (const Finding& finding : findings)
    if (finding.code == code) return finding.count;
  return 0;
}

struct Case {
  BakedColors baked;
  ColorOutput output;
  double shown = 0;  ///< The largest difference that the file shows.
};

/// A ball under a sun and a lamp, written as one of the formats with this finish.
Case write_and_look(Format format, ColorStorage storage, const Finish& finish, double tolerance) {
  SceneFile file;
  file.scene = scene_of(
      icosphere(2), {sun({0.4f, 1, 0.3f}, {0.8f, 0.7f, 0.5f}), lamp({-1.5f, -0.5f, 1}, {0.1f, 0.2f, 0.3f})});
  file.scene.materials[0].base_color = finish.base, file.scene.materials[0].emission = finish.emission;
  if (format == Format::asset) {
    const std::vector<Light> lights = file.scene.lights;
    write_asset(temporary_file("in.gltf"), file.scene);
    file = read_gltf_file(temporary_file("in.gltf"), {});
    file.scene.lights = lights;
  }
  const std::string path = temporary_file(format == Format::ply ? "out.ply" : "out.glb");
  Case result;
  const bool is_ply = format == Format::ply;
  result.output = is_ply ? ply_output(file.scene, {.color = storage}) : gltf_output(file, {.color = storage});
  result.baked =
      bake(file.scene, {.method = BakeMethod::adaptive, .tolerance = tolerance, .output = result.output});
  if (is_ply)
    write_ply_file(path, file.scene, result.baked, {.color = storage});
  else
    write_gltf_file(path, file, result.baked, {.color = storage});
  const Shown shown = is_ply
                          ? shown_by_ply(path, result.baked.mesh->n_vertices(), storage == ColorStorage::f32)
                          : shown_by_glb(path);
  result.shown = largest_difference(file.scene, result.baked, shown);
  return result;
}

// Far below half a step of any storage: roundings of floats in the file and here.
constexpr double rounding = 2e-6;

TEST(CertificateOfFile, EveryFinishFormatAndStorage_ShowsNoMoreThanIsCertified) {
  std::size_t n_certified = 0;
  for (const Format format : {Format::new_glb, Format::asset, Format::ply})
    for (const ColorStorage storage : {ColorStorage::u8, ColorStorage::u16, ColorStorage::f32}) {
      if (format == Format::ply && storage == ColorStorage::u16) continue;
      for (std::size_t i = 0; i < std::size(finishes); ++i) {
        SCOPED_TRACE(testing::Message()
                     << "format " << int(format) << " storage " << int(storage) << " finish " << i);
        // Linear bytes are too coarse for 1/255: half a step is 6.5/255 at black.
        const bool is_coarse = storage == ColorStorage::u8 && format != Format::ply;
        const double tolerance = (is_coarse ? 14.0 : 1.0) / 255;
        const Case c = write_and_look(format, storage, finishes[i], tolerance);
        const Certificate& certificate = *c.baked.certificate;
        EXPECT_LE(c.shown, certificate.max_bound + rounding);
        if (certificate.is_certified) {
          ++n_certified;
          EXPECT_LE(c.shown, tolerance + rounding);
        }
        // What clips or cannot be written is emission of an asset, and is told with its size where it has
        // one.
        if (format != Format::asset && !is_coarse) {
          EXPECT_TRUE(certificate.is_certified);
        }
        if (c.shown > tolerance + rounding && c.output.gaps.empty()) {
          EXPECT_FALSE(certificate.is_certified);
          EXPECT_LT(certificate.max_bound, 1.4 * c.shown);
        }
      }
    }
  EXPECT_GT(n_certified, 60U);
}

TEST(CertificateOfFile, EmissionThatClips_IsNotCertified) {
  const Case c = write_and_look(Format::asset, ColorStorage::u16, finishes[2], 1.0 / 255);
  EXPECT_GT(c.shown, 88.0 / 255);
  EXPECT_FALSE(c.baked.certificate->is_certified);
  EXPECT_GT(count_of(c.baked.findings, "triangles_open_by_storage"), 0U);
}

TEST(CertificateOfFile, EmissionThatIsNotWritten_HasNoBound) {
  const Case c = write_and_look(Format::asset, ColorStorage::f32, finishes[8], 1.0 / 255);
  EXPECT_GT(c.shown, 200.0 / 255);
  EXPECT_FALSE(c.baked.certificate->is_certified);
  EXPECT_TRUE(std::isinf(c.baked.certificate->max_bound));
  EXPECT_EQ(count_of(c.baked.findings, "certificate_not_of_file"), 1U);
}

// What is left out on reading stays in the file.
TEST(CertificateOfFile, TexturesThatAreNotRead_HaveNoBound) {
  Scene scene = scene_of(icosphere(1), {sun({0, 1, 0})});
  write_asset(temporary_file("in.gltf"), scene);
  auto json = nlohmann::ordered_json::parse(read_bytes(temporary_file("in.gltf")));
  json["textures"] = {nlohmann::ordered_json::object()};  // Without a source.
  for (const char* key : {"baseColorTexture", "emissiveTexture"}) {
    auto with = json;
    const bool is_base = std::string(key) == "baseColorTexture";
    auto& material = with["materials"][0];
    (is_base ? material["pbrMetallicRoughness"] : material)[key] = {{"index", 0}};
    write_bytes(temporary_file("unread.gltf"), with.dump());
    const SceneFile file = read_gltf_file(temporary_file("unread.gltf"), {});
    // No emission, no need of its texture.
    EXPECT_EQ(count_of(gltf_output(file, {}).gaps, "certificate_not_of_file"), is_base ? 1U : 0U) << key;
  }
}

// An exposure scales what is baked, not the materials that are written back.
TEST(CertificateOfFile, EmissionThatStaysAsInTheFile_HasNoBoundIfAnotherIsBaked) {
  Scene scene = scene_of(icosphere(1), {sun({0, 1, 0})});
  scene.materials[0].emission = {0.3f, 0.1f, 0};
  write_asset(temporary_file("in.gltf"), scene);
  SceneFile file = read_gltf_file(temporary_file("in.gltf"), {});
  file.scene.lights = scene.lights;
  const GltfWriteOptions lit{.mark_unlit = false}, beside{.attribute = "_LIGHT"};
  EXPECT_TRUE(gltf_output(file, lit).gaps.empty());
  EXPECT_TRUE(gltf_output(file, beside).gaps.empty());
  file.scene.materials[0].emission = {0.6f, 0.2f, 0};
  EXPECT_TRUE(gltf_output(file, {}).gaps.empty());  // In the colours.
  for (const GltfWriteOptions& options : {lit, beside}) {
    const ColorOutput output = gltf_output(file, options);
    EXPECT_EQ(count_of(output.gaps, "certificate_not_of_file"), 1U);
    const BakedColors baked = bake(file.scene, {.method = BakeMethod::adaptive, .output = output});
    EXPECT_FALSE(baked.certificate->is_certified);
    const WrittenColors written = write_gltf_file(temporary_file("out.glb"), file, baked, options);
    EXPECT_EQ(count_of(written.findings, "emission_of_file"), 1U);
  }
  file.scene.materials[0].is_unlit = true;  // Shows none.
  EXPECT_TRUE(gltf_output(file, beside).gaps.empty());
}

// Linear bytes behind a base colour of 0: 0.0019 becomes 0 or 1/255, whatever the light is.
TEST(CertificateOfFile, EmissionThatIsRounded_IsInTheBound) {
  const Case c = write_and_look(Format::new_glb, ColorStorage::u8, {{0, 0, 0}, {0.0019f, 0, 1}}, 1.0 / 255);
  EXPECT_GT(c.shown, 6.0 / 255);
  EXPECT_NEAR(c.baked.certificate->max_bound, c.shown, rounding);
  EXPECT_FALSE(c.baked.certificate->is_certified);
  EXPECT_EQ(c.baked.certificate->open_triangles, 0U);
  EXPECT_EQ(count_of(c.baked.findings, "emission_open_by_storage"), 1U);
}

/// A ball with a texture of one texel.
SceneFile textured_ball() {
  SceneFile file;
  file.scene = scene_of(icosphere(1), {sun({0.4f, 1, 0.3f})});
  file.scene.mesh.texcoords[0].resize(file.scene.mesh.n_vertices());
  file.scene.images.push_back({1, 1, {{0.5f, 0.25f, 1, 1}}});
  file.scene.textures.emplace_back();
  return file;
}

TEST(GapsOfOutput, Textures_AreNoneInGlb_ButInPly) {
  SceneFile file = textured_ball();
  Material& material = file.scene.materials[0];
  EXPECT_TRUE(ply_output(file.scene, {}).gaps.empty());
  material.base_color_texture = 0;
  EXPECT_TRUE(gltf_output(file, {}).gaps.empty());
  EXPECT_EQ(ply_output(file.scene, {}).gaps.size(), 1U);
  // Emission beside a texture is in no vertex colour; an unlit material has none.
  material.emission = {0.1f, 0, 0};
  EXPECT_EQ(gltf_output(file, {}).gaps.size(), 1U);
  material.is_unlit = true;
  EXPECT_TRUE(gltf_output(file, {}).gaps.empty());
  // Nor has a material of no triangle a part in the file.
  material.is_unlit = false;
  file.scene.mesh.triangles.clear();
  EXPECT_TRUE(gltf_output(file, {}).gaps.empty());
  EXPECT_TRUE(ply_output(file.scene, {}).gaps.empty());
}

TEST(GapsOfOutput, LightBesideVertexColours_IsOne) {
  const SceneFile file = read_gltf_file(meshes_folder() + "gltf/BoxVertexColors.glb", {});
  EXPECT_TRUE(gltf_output(file, {}).gaps.empty());
  ASSERT_EQ(gltf_output(file, {.attribute = "_LIGHT"}).gaps.size(), 1U);
  EXPECT_EQ(gltf_output(file, {.attribute = "_LIGHT"}).gaps[0].count, 1U);
  const SceneFile plain = read_gltf_file(meshes_folder() + "gltf/Duck.glb", {});
  EXPECT_TRUE(gltf_output(plain, {.attribute = "_LIGHT"}).gaps.empty());
}

TEST(GapsOfOutput, Select_GoesByTheLightAlone) {
  SceneFile file = textured_ball();
  file.scene.materials[0].base_color_texture = 0;
  const Selection selection = select_method(file.scene, {.output = ply_output(file.scene, {})});
  ASSERT_EQ(selection.trials.size(), 4U);
  EXPECT_FALSE(selection.is_certified);
  EXPECT_EQ(selection.trials[selection.chosen].method, BakeMethod::adaptive);
  for (const MethodTrial& trial : selection.trials) {
    EXPECT_TRUE(std::isinf(trial.max_bound));
    EXPECT_GE(trial.max_found, selection.trials[selection.chosen].max_found);
  }
  EXPECT_EQ(selection.sentence.rfind("nothing can be certified: 1 material has a texture", 0), 0U)
      << selection.sentence;
  EXPECT_EQ(count_of(selection.baked.findings, "certificate_not_of_file"), 1U);
}

}  // namespace
}  // namespace lambake
