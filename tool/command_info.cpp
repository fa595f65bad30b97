#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lambake/core/bounds.h"
#include "lambake/core/digits.h"
#include "lambake/geometry/defects.h"
#include "lambake/io/scene_file.h"
#include "lambake/report/json_parts.h"

namespace lambake::tool {
namespace {

struct InfoCommand {
  std::string input;
  std::string gltf_scene;
  bool json = false;
};

nlohmann::ordered_json vector_json(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json describe(const SceneFile& file) {
  const Scene& scene = file.scene;
  const Mesh& mesh = scene.mesh;
  nlohmann::ordered_json json;
  json["format"] = file.format;
  json["file_vertices"] = file.n_vertices;
  json["file_faces"] = file.n_faces;
  json["vertices"] = mesh.n_vertices();
  json["triangles"] = mesh.n_triangles();
  json["has_normals"] = !mesh.normals.empty();
  json["has_colors"] = !mesh.colors.empty();
  json["texcoord_sets"] = (mesh.texcoords[0].empty() ? 0 : 1) + (mesh.texcoords[1].empty() ? 0 : 1);
  const Bounds bounds = bounds_of(mesh.positions);
  if (!bounds.is_empty()) {
    json["min"] = vector_json(bounds.min);
    json["max"] = vector_json(bounds.max);
    json["extent"] = vector_json(bounds.max - bounds.min);
  }
  json["materials"] = nlohmann::ordered_json::array();
  for (const Material& m : scene.materials)
    json["materials"].push_back({{"name", m.name},
                                 {"base_color", {m.base_color.r, m.base_color.g, m.base_color.b}},
                                 {"textured", m.base_color_texture != no_texture},
                                 {"emissive", m.emission != LinearRgb{}},
                                 {"double_sided", m.is_double_sided},
                                 {"unlit", m.is_unlit}});
  json["images"] = scene.images.size();
  json["lights"] = nlohmann::ordered_json::array();
  for (const Light& light : scene.lights) {
    const char* type = light.type == LightType::directional ? "directional"
                       : light.type == LightType::point     ? "point"
                                                            : "spot";
    json["lights"].push_back({{"type", type},
                              {"name", light.name},
                              {"intensity", {light.intensity.r, light.intensity.g, light.intensity.b}}});
  }
  json["cameras"] = nlohmann::ordered_json::array();
  for (const Camera& camera : scene.cameras) json["cameras"].push_back(camera.name);

  const Defects d = find_defects(mesh);
  json["components"] = d.components;
  json["closed"] = d.is_closed;
  json["consistently_wound"] = d.is_consistently_wound;
  json["border_edges"] = d.border_edges;
  json["non_manifold_edges"] = d.non_manifold_edges;
  json["conflicting_edges"] = d.conflicting_edges;
  json["zero_area_faces"] = d.zero_area_faces;
  json["repeated_vertex_faces"] = d.repeated_vertex_faces;
  json["duplicate_faces"] = d.duplicate_faces;
  json["duplicate_positions"] = d.duplicate_positions;
  json["isolated_vertices"] = d.isolated_vertices;
  json["non_finite_vertices"] = d.non_finite_vertices;
  json["findings"] = findings_json(file.findings);
  return json;
}

std::string with_blanks(std::string key) {
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

std::string for_people(const nlohmann::ordered_json& value) {
  if (value.is_string()) return on_one_line(value.get<std::string>());
  if (value.is_number_unsigned()) return group_digits(value.get<std::size_t>());
  if (value.is_number()) return fmt::format("{}", value.get<float>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.empty()) return "none";
  std::vector<std::string> parts;
  for (const auto& [key, part] : value.items()) {
    if (value.is_array())
      parts.push_back(for_people(part));
    else if (key == "name")
      parts.push_back(fmt::format("\"{}\"", for_people(part)));
    else if (part.is_boolean() && part.get<bool>())
      parts.push_back(with_blanks(key));
    else if (!part.is_boolean())
      parts.push_back(fmt::format("{} {}", with_blanks(key), for_people(part)));
  }
  const bool has_numbers = value.is_array() && value[0].is_number();
  return fmt::format("{}", fmt::join(parts, has_numbers ? " " : ", "));
}

/// One line per entry; what is 0 or false stays, so that two files can be compared line by line.
void print_for_people(const nlohmann::ordered_json& json) {
  for (const auto& [key, value] : json.items()) {
    if (key == "findings") {
      for (const auto& finding : value)
        print_result("{:<22} {} {}\n", "noticed", group_digits(finding["count"].get<std::size_t>()),
                     finding["text"].get<std::string>());
      continue;
    }
    if (value.is_array() && !value.empty() && value[0].is_object()) {
      for (const auto& entry : value) print_result("{:<22} {}\n", with_blanks(key), for_people(entry));
    } else {
      print_result("{:<22} {}\n", with_blanks(key), for_people(value));
    }
  }
}

}  // namespace

void add_info_command(CLI::App& app, Run& run) {
  auto command = std::make_shared<InfoCommand>();
  CLI::App& sub = *app.add_subcommand("info", "what is in the file and what in it could fail");
  sub.add_option("INPUT", command->input, "mesh or scene: .ply .obj .off .stl .om .gltf .glb")->required();
  sub.add_option("--scene", command->gltf_scene, "scene of a glTF file, by name or number");
  sub.add_flag("--json", command->json, "as JSON on standard output");
  sub.footer("Example: lambake info bunny.ply --json");
  sub.callback([command, &run] {
    run = [command](const std::string&) {
      const SceneFile file = read_scene_file(command->input, {.gltf_scene = command->gltf_scene});
      const nlohmann::ordered_json json = describe(file);
      if (command->json) {
        print_result("{}\n", json_text(json));
      } else {
        print_for_people(json);
      }
      return 0;
    };
  });
}

}  // namespace lambake::tool
