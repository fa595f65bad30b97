#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "bake_options.h"
#include "commands.h"
#include "lambake/core/digits.h"
#include "lambake/io/file_extension.h"
#include "lambake/report/json_parts.h"
#include "options.h"

namespace lambake::tool {
namespace {

struct BakeCommand {
  SceneOptions scene;
  BakeMethodOptions method;
  OutputOptions output;
  std::vector<std::string> outputs;
};

/// What is certified, and for auto what was chosen.
void print_verdict(const BakeCommand& command, const BakedScene& result) {
  const std::string of = command.outputs.size() > 1 ? command.outputs.front() + ", " : "";
  if (result.selection)
    print_result("{}{}\n", of, result.selection->sentence);
  else if (const std::optional<Certificate>& c = result.baked.certificate)
    print_result(
        "{}{}: {} from per-pixel lighting anywhere\n", of, c->is_certified ? "certified" : "not certified",
        std::isfinite(c->max_bound) ? fmt::format("at most {}/255", upper_bound_text(c->max_bound * 255))
                                    : "no bound to how far it is");
}

int bake_and_write(const BakeCommand& command) {
  Console console(command.scene.quiet);
  Stopwatch stopwatch;
  for (const std::string& path : command.outputs) {
    check_baked_path(path, command.output);
    check_keeps_input(command.scene, path, path);
  }
  check_distinct(command.outputs);
  tell_unheeded_outputs(command.outputs, command.output, console);
  const BakeOptions how = bake_options(command.method, console);
  LoadedScene loaded = load_scene(command.scene, console, stopwatch, Up::y, command.method.method == "face");
  for (const std::string& path : command.outputs) {
    check_keeps_referred(loaded.file, path, path);
    check_levels(command.method, path, loaded.file);
  }
  console.stage("baking");
  const BakedScene result = bake_scene(loaded.file.scene, command.method, how, console,
                                       output_of(command.outputs.front(), loaded.file, command.output));
  const BakedColors& baked = result.baked;
  console.tell(baked.findings);
  stopwatch.lap("bake");

  console.stage("writing");
  nlohmann::ordered_json json;
  const Mesh& mesh = mesh_of(loaded.file.scene, baked);
  json["input"] = input_name(command.scene);
  json["format"] = loaded.file.format;
  json["method"] = command.method.method;
  json["normals"] = loaded.normals;
  add_method_json(json, result);
  json["vertices"] = mesh.n_vertices();
  json["triangles"] = mesh.n_triangles();
  json["lights"] = loaded.file.scene.lights.size();
  json["light_error"] = {{"linear", baked.light_error.linear}, {"display", baked.light_error.display}};
  json["outputs"] = nlohmann::ordered_json::array();
  Findings findings = loaded.file.findings;
  findings.insert(findings.end(), baked.findings.begin(), baked.findings.end());
  for (const std::string& path : command.outputs) {
    WrittenColors written = write_baked(path, loaded.file, baked, command.output);
    const std::string& first = command.outputs.front();
    const auto is_ply = [](const std::string& name) { return file_extension(name) == "ply"; };
    if ((baked.certificate || result.selection) && is_ply(path) != is_ply(first))
      add_finding(written.findings, "certificate_of_another_file", 1,
                  "output stores colours otherwise than the first: the certificate is of " + first +
                      ", not of " + path);
    Findings news = written.findings;
    std::erase_if(news, [&](const Finding& f) {
      return std::any_of(baked.findings.begin(), baked.findings.end(),
                         [&](const Finding& told) { return told.count == f.count && told.text == f.text; });
    });
    if (command.outputs.size() > 1)
      for (Finding& finding : news) finding.text += fmt::format(" ({})", path);
    console.tell(news);
    json["outputs"].push_back({{"path", path},
                               {"bytes", baked_bytes(path)},
                               {"vertices", written.n_vertices},
                               {"clipped_vertices", written.clipped_vertices},
                               {"findings", findings_json(written.findings)}});
    if (command.scene.tells_people()) {
      console.clear_bar();
      print_result("{}: {} {}, {} {}, {} bytes\n", path, group_digits(written.n_vertices),
                   in_number(written.n_vertices, "vert[ex|ices]"), group_digits(mesh.n_triangles()),
                   in_number(mesh.n_triangles(), "triangle[|s]"), group_digits(baked_bytes(path)));
    }
  }
  stopwatch.lap("write");
  console.clear_bar();
  if (command.scene.tells_people()) print_verdict(command, result);
  json["findings"] = findings_json(findings);
  json["seconds"] = seconds_json(stopwatch.seconds());
  if (command.scene.json) print_result("{}\n", json_text(json));
  return 0;
}

}  // namespace

void add_bake_command(CLI::App& app, Run& run) {
  auto command = std::make_shared<BakeCommand>();
  CLI::App& sub = *app.add_subcommand("bake", "bake light into vertex colours: GLB, glTF, PLY");
  add_scene_options(sub, command->scene);
  add_bake_options(sub, command->method);
  add_output_options(sub, command->output);
  sub.add_option("-o,--output", command->outputs, ".glb, .gltf or .ply to write; repeatable")
      ->required()
      ->allow_extra_args(false);
  sub.footer("Example: lambake bake bunny.ply --sun 0.4,1,0.3 -o bunny.glb -o bunny_lit.ply");
  sub.callback([command, &run] { run = [command](const std::string&) { return bake_and_write(*command); }; });
}

}  // namespace lambake::tool
