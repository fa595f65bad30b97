/// Writes meshes/gallery.glb: a small room with sculptures, for which light per vertex is not enough.
/// usage: generate_gallery FILE.glb

#include <tiny_gltf.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "gallery_textures.h"
#include "lambake/core/bounds.h"
#include "lambake/geometry/creases.h"
#include "lambake/geometry/normals.h"
#include "lambake/io/image_file.h"
#include "shapes.h"

namespace lambake {
namespace {

using Vec3 = glm::vec3;

/// Appends a flat rectangle of n_u × n_v quads: from `corner` along `u` and `v`, facing u × v; one texture
/// tile per `tile` metres.
void add_rectangle(Mesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, unsigned n_u, unsigned n_v,
                   float tile) {
  const auto first = static_cast<std::uint32_t>(mesh.n_vertices());
  const Vec3 normal = glm::normalize(glm::cross(u, v));
  for (unsigned j = 0; j <= n_v; ++j)
    for (unsigned i = 0; i <= n_u; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(n_u);
      const float t = static_cast<float>(j) / static_cast<float>(n_v);
      mesh.positions.push_back(corner + s * u + t * v);
      mesh.normals.push_back(normal);
      mesh.texcoords[0].push_back(tile > 0 ? glm::vec2(s * glm::length(u), -t * glm::length(v)) / tile
                                           : glm::vec2(s, 1 - t));
    }
  for (std::uint32_t j = 0; j < n_v; ++j)
    for (std::uint32_t i = 0; i < n_u; ++i) {
      const std::uint32_t a = first + j * (n_u + 1) + i, b = a + 1, c = a + n_u + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
    }
}

/// The four upright sides and the top of a box on the floor: nobody sees its bottom.
Mesh pedestal(float half_width, float height) {
  Mesh mesh;
  const float w = half_width, d = 2 * half_width;
  const Vec3 up(0, height, 0);
  add_rectangle(mesh, {-w, 0, w}, {d, 0, 0}, up, 2, 3, 1);
  add_rectangle(mesh, {w, 0, w}, {0, 0, -d}, up, 2, 3, 1);
  add_rectangle(mesh, {w, 0, -w}, {-d, 0, 0}, up, 2, 3, 1);
  add_rectangle(mesh, {-w, 0, -w}, {0, 0, d}, up, 2, 3, 1);
  add_rectangle(mesh, {-w, height, w}, {d, 0, 0}, {0, 0, -d}, 2, 2, 1);
  return mesh;
}

Mesh rectangle(const Vec3& corner, const Vec3& u, const Vec3& v, unsigned n_u, unsigned n_v, float tile) {
  Mesh mesh;
  add_rectangle(mesh, corner, u, v, n_u, n_v, tile);
  return mesh;
}

Mesh creased_box() {
  Mesh mesh = rounded_box(3);
  split_creases(mesh, std::numbers::pi_v<float> / 6);
  mesh.normals = vertex_normals(mesh, NormalWeight::angle).normals;
  return mesh;
}

tinygltf::Value object(std::initializer_list<std::pair<const std::string, tinygltf::Value>> members) {
  return tinygltf::Value(tinygltf::Value::Object(members));
}

/// The file, put together from the top down: each function returns the index of what it added.
class Gallery {
 public:
  tinygltf::Model build() {
    model_.asset.version = "2.0";
    model_.asset.generator = "lambake generate_gallery";
    model_.buffers.emplace_back();
    model_.scenes.emplace_back().name = "gallery";
    model_.defaultScene = 0;
    model_.extensionsUsed = {"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit"};
    tinygltf::Sampler sampler;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    model_.samplers.push_back(sampler);
    add_room();
    add_sculptures();
    add_lights();
    add_cameras();
    return std::move(model_);
  }

 private:
  void add_room() {
    const int wood = material("floor", {1, 1, 1}, texture("wood", wood_planks()));
    const int plaster = material("wall", {0.80f, 0.77f, 0.72f});
    node("floor", mesh("floor", rectangle({-5, 0, 4}, {10, 0, 0}, {0, 0, -8}, 8, 7, 2.5f), wood));
    node("back wall", mesh("back wall", rectangle({-5, 0, -4}, {10, 0, 0}, {0, 4, 0}, 9, 4, 0), plaster));
    node("left wall", mesh("left wall", rectangle({-5, 0, 4}, {0, 0, -8}, {0, 4, 0}, 7, 4, 0), plaster));
    node("right wall", mesh("right wall", rectangle({5, 0, -4}, {0, 0, 8}, {0, 4, 0}, 7, 4, 0), plaster));
    node("ceiling", mesh("ceiling", rectangle({-5, 4, -4}, {10, 0, 0}, {0, 0, 8}, 8, 7, 0), plaster));
    const int frame = material("frame", {0.10f, 0.08f, 0.07f});
    const int painting = material("painting", {1, 1, 1}, texture("painting", dusk_painting()));
    const int frame_mesh =
        mesh("frame", rectangle({-1.0f, 1.75f, -3.97f}, {2.0f, 0, 0}, {0, 1.5f, 0}, 2, 2, 0), frame);
    const int painting_mesh =
        mesh("painting", rectangle({-0.92f, 1.83f, -3.95f}, {1.84f, 0, 0}, {0, 1.34f, 0}, 3, 2, 0), painting);
    for (const float x : {-1.9f, 1.9f}) {
      node("frame", frame_mesh, {x, 0, 0});
      node("painting", painting_mesh, {x, 0, 0});
    }
    const int sky = material("window", {0.62f, 0.78f, 0.95f});
    model_.materials[index_of(sky)].extensions["KHR_materials_unlit"] =
        tinygltf::Value(tinygltf::Value::Object());
    node("window frame",
         mesh("window frame", rectangle({-4.97f, 1.1f, -0.2f}, {0, 0, -2.2f}, {0, 2.1f, 0}, 2, 2, 0), frame));
    const int pane = mesh("pane", rectangle({-4.95f, 1.2f, 0}, {0, 0, -0.95f}, {0, 1.9f, 0}, 1, 1, 0), sky);
    node("pane", pane, {0, 0, -0.3f});
    node("pane", pane, {0, 0, -1.35f});
  }

  void add_sculptures() {
    const int marble = material("marble", {0.95f, 0.94f, 0.92f}, texture("marble", marble_veins()));
    const int stand = mesh("pedestal", pedestal(0.5f, 1.0f), marble);
    node("pedestal", stand, {0, 0, -1.2f}, {1.2f, 0.8f, 1.2f});
    for (const Vec3& at :
         {Vec3(-2.0f, 0, 0.5f), Vec3(2.0f, 0, 0.5f), Vec3(-3.7f, 0, -2.8f), Vec3(3.7f, 0, -2.8f)})
      node("pedestal", stand, at);

    Mesh knot_shape = torus_knot(72, 9, 0.2f);
    knot_shape.colors.clear();
    const int knot = mesh("knot", knot_shape, material("gold", {0.95f, 0.64f, 0.22f}));
    node("knot", knot, {0, 1.78f, -1.2f}, Vec3(0.68f), 20, 68);
    node("mirrored knot", knot, {3.7f, 1.64f, -2.8f}, {-0.45f, 0.45f, 0.45f}, -25, 62);

    Mesh ball_shape = uv_sphere(10, 16);
    const int ball = mesh("ball", ball_shape, material("porcelain", {0.92f, 0.92f, 0.90f}));
    node("ball", ball, {-2.0f, 1.55f, 0.5f}, Vec3(0.55f));
    node("egg", ball, {-3.7f, 1.8f, -2.8f}, {0.4f, 0.8f, 0.4f});  // Normals are not scaled as positions are.

    node("box", mesh("box", creased_box(), material("jade", {0.20f, 0.62f, 0.45f})), {2.0f, 1.37f, 0.5f},
         Vec3(0.46f), 28);
  }

  void add_lights() {
    const int bulb_shape = mesh("bulb", uv_sphere(6, 10), material("bulb", {1, 1, 1}));
    const int cord = mesh("cord", pedestal(0.012f, 1.0f), material("cord", {0.03f, 0.03f, 0.03f}));
    const auto lamp = [&](const std::string& name, const Vec3& at, const Vec3& color, double candela,
                          double range) {
      tinygltf::Light light;
      light.name = name;
      light.type = "point";
      light.color = {color.r, color.g, color.b};
      light.intensity = candela;
      light.range = range;
      node_light(node(name, -1, at), light);
      const int glow = material(name + " glow", {1, 1, 1});
      tinygltf::Material& glowing = model_.materials[index_of(glow)];
      glowing.emissiveFactor = {color.r, color.g, color.b};
      glowing.extensions["KHR_materials_emissive_strength"] =
          object({{"emissiveStrength", tinygltf::Value(0.55)}});
      tinygltf::Mesh bulb = model_.meshes[index_of(bulb_shape)];
      bulb.name = name + " bulb";
      bulb.primitives[0].material = glow;
      model_.meshes.push_back(bulb);
      node(name + " bulb", static_cast<int>(model_.meshes.size()) - 1, at, Vec3(0.085f));
      if (at.y > 1.5f) node("cord", cord, at, {1, 4 - at.y, 1});
    };
    lamp("amber lamp", {-2.9f, 2.6f, 0.9f}, {1, 0.50f, 0.15f}, 9, 0);
    lamp("blue lamp", {2.95f, 2.45f, 1.05f}, {0.18f, 0.46f, 1}, 9.5, 7);
    lamp("rose lamp", {0, 0.35f, -3.1f}, {1, 0.16f, 0.40f}, 3.2, 0);

    tinygltf::Light spot;
    spot.name = "spot";
    spot.type = "spot";
    spot.color = {1, 0.95, 0.85};
    spot.intensity = 24;
    spot.spot.innerConeAngle = 0.18;
    spot.spot.outerConeAngle = 0.42;
    node_light(aimed_node("spot", {0.5f, 3.9f, 1.2f}, {0, 1.4f, -1.2f}), spot);

    tinygltf::Light sun;
    sun.name = "evening sun";
    sun.type = "directional";
    sun.color = {1, 0.88, 0.72};
    sun.intensity = 0.85;
    node_light(aimed_node("evening sun", {-6, 5, 4}, {0, 0, 0}), sun);
  }

  void add_cameras() {
    camera("room", {0.5, 2.0, 9.6}, {0, 1.75, -1.5}, 0.52);
    camera("knot", {1.3, 2.4, 2.2}, {-0.1, 1.6, -1.3}, 0.75);
  }

  static std::size_t index_of(int i) { return static_cast<std::size_t>(i); }

  int append_view(const void* bytes, std::size_t n_bytes, int target) {
    std::vector<unsigned char>& data = model_.buffers[0].data;
    data.resize((data.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = n_bytes;
    view.target = target;
    const auto* first = static_cast<const unsigned char*>(bytes);
    data.insert(data.end(), first, first + n_bytes);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  template <typename T>
  int accessor(const std::vector<T>& values, std::size_t count, int component_type, int type, int target) {
    tinygltf::Accessor accessor;
    accessor.bufferView = append_view(values.data(), values.size() * sizeof(T), target);
    accessor.componentType = component_type;
    accessor.count = count;
    accessor.type = type;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int mesh(const std::string& name, const Mesh& from, int material) {
    tinygltf::Primitive primitive;
    const std::size_t n = from.n_vertices();
    constexpr int is_float = TINYGLTF_COMPONENT_TYPE_FLOAT, for_vertices = TINYGLTF_TARGET_ARRAY_BUFFER;
    const int positions = accessor(from.positions, n, is_float, TINYGLTF_TYPE_VEC3, for_vertices);
    const Bounds box = bounds_of(from.positions);
    model_.accessors.back().minValues = {box.min.x, box.min.y, box.min.z};
    model_.accessors.back().maxValues = {box.max.x, box.max.y, box.max.z};
    primitive.attributes["POSITION"] = positions;
    primitive.attributes["NORMAL"] = accessor(from.normals, n, is_float, TINYGLTF_TYPE_VEC3, for_vertices);
    if (!from.texcoords[0].empty())
      primitive.attributes["TEXCOORD_0"] =
          accessor(from.texcoords[0], n, is_float, TINYGLTF_TYPE_VEC2, for_vertices);
    std::vector<std::uint16_t> indices;
    for (const glm::uvec3& t : from.triangles)
      for (int c = 0; c < 3; ++c) indices.push_back(static_cast<std::uint16_t>(t[c]));
    primitive.indices = accessor(indices, indices.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                 TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(primitive);
    model_.meshes.push_back(mesh);
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  int texture(const std::string& name, const Picture& picture) {
    const std::string png = encode_png(picture);
    tinygltf::Image image;
    image.name = name;
    image.mimeType = "image/png";
    image.bufferView = append_view(png.data(), png.size(), 0);
    model_.images.push_back(image);
    tinygltf::Texture texture;
    texture.source = static_cast<int>(model_.images.size()) - 1;
    texture.sampler = 0;
    model_.textures.push_back(texture);
    return static_cast<int>(model_.textures.size()) - 1;
  }

  int material(const std::string& name, const Vec3& base_color, int texture = -1) {
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = {base_color.r, base_color.g, base_color.b, 1};
    material.pbrMetallicRoughness.metallicFactor = 0;
    material.pbrMetallicRoughness.baseColorTexture.index = texture;
    model_.materials.push_back(material);
    return static_cast<int>(model_.materials.size()) - 1;
  }

  tinygltf::Node& node(const std::string& name, int mesh, const Vec3& at = Vec3(0),
                       const Vec3& scale = Vec3(1), double turn_deg = 0, double tilt_deg = 0) {
    tinygltf::Node node;
    node.name = name;
    node.mesh = mesh;
    if (at != Vec3(0)) node.translation = {at.x, at.y, at.z};
    if (scale != Vec3(1)) node.scale = {scale.x, scale.y, scale.z};
    const double turn = turn_deg * std::numbers::pi / 360,
                 tilt = tilt_deg * std::numbers::pi / 360;  // Halves.
    if (turn_deg != 0 || tilt_deg != 0)
      node.rotation = {std::cos(turn) * std::sin(tilt), std::sin(turn) * std::cos(tilt),
                       -std::sin(turn) * std::sin(tilt), std::cos(turn) * std::cos(tilt)};
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size()));
    return model_.nodes.emplace_back(node);
  }

  /// A node at `eye` whose −z points to `target`, as lights and cameras look.
  tinygltf::Node& aimed_node(const std::string& name, const glm::dvec3& eye, const glm::dvec3& target) {
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    const glm::dvec3 up = glm::cross(back, right);
    tinygltf::Node& made = node(name, -1);
    made.matrix = {right.x, right.y, right.z, 0, up.x,  up.y,  up.z,  0,
                   back.x,  back.y,  back.z,  0, eye.x, eye.y, eye.z, 1};
    return made;
  }

  void node_light(tinygltf::Node& node, const tinygltf::Light& light) {
    node.extensions["KHR_lights_punctual"] =
        object({{"light", tinygltf::Value(static_cast<int>(model_.lights.size()))}});
    model_.lights.push_back(light);
  }

  void camera(const std::string& name, const glm::dvec3& eye, const glm::dvec3& target, double fov_rad) {
    tinygltf::Camera camera;
    camera.name = name;
    camera.type = "perspective";
    camera.perspective.yfov = fov_rad;
    camera.perspective.aspectRatio = 16.0 / 9.0;
    camera.perspective.znear = 0.1;
    camera.perspective.zfar = 100;
    aimed_node(name, eye, target).camera = static_cast<int>(model_.cameras.size());
    model_.cameras.push_back(camera);
  }

  tinygltf::Model model_;
};

}  // namespace
}  // namespace lambake

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: generate_gallery FILE.glb\n", stderr);
    return 2;
  }
  const std::string path = argv[1];
  const tinygltf::Model model = lambake::Gallery().build();
  if (!tinygltf::TinyGLTF().WriteGltfSceneToFile(&model, path, /* embed images */ true,
                                                 /* embed buffers */ true,
                                                 /* pretty */ false, /* binary */ true)) {
    std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
    return 3;
  }
}
