#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "lambake/core/digits.h"
#include "lambake/core/version.h"
#include "lambake/io/gltf.h"
#include "lambake/io/output_file.h"
#include "lambake/io/output_folder.h"
#include "lambake/report/chart_report.h"
#include "options.h"

namespace lambake::tool {
namespace {

struct ChartCommand {
  SceneOptions scene;
  CameraOptions camera;
  std::string folder;
  std::vector<std::string> methods;
  double budget_seconds = 60;
};

constexpr const char* output_names[] = {"chart.json",      "chart.csv",        "chart.svg",
                                        "chart_bound.svg", "chart_lights.svg", "chart_vertices.svg",
                                        "index.html"};

int chart_and_write(const ChartCommand& command, const std::string& command_line) {
  Console console(command.scene.quiet);
  Stopwatch stopwatch;
  check_output_folder(command.folder);
  check_page_is_ours(command.folder, "chart");
  for (const char* name : output_names)
    check_keeps_input(command.scene, std::filesystem::path(command.folder) / name, command.folder);
  check_camera_options(command.camera);
  const LoadedScene loaded = load_scene(command.scene, console, stopwatch, up_of(command.camera));
  console.stage("measuring");
  ChartRun run =
      run_chart(loaded.file.scene,
                {.methods = command.methods,
                 .budget_seconds = command.budget_seconds,
                 .camera = choose_camera(command.camera, loaded.file.scene, {16, 9}),
                 .output = [&](ColorStorage color) { return gltf_output(loaded.file, {.color = color}); },
                 .progress = console.progress()});
  run.input = input_name(command.scene);
  run.command = command_line;
  run.version = version();
  console.clear_bar();
  if (!run.left_out.empty())
    console.note(fmt::format("left out, as {} seconds were not enough (--budget-seconds): {}",
                             command.budget_seconds, fmt::join(run.left_out, "; ")));

  OutputFolder folder(command.folder);
  constexpr double width = 1080, height = 640;
  write_file(folder.file("chart.json"), chart_json(run));
  write_file(folder.file("chart.csv"), chart_csv(run));
  for (const auto& [name, chart] : {std::pair{"chart.svg", speed_chart(run)},
                                    {"chart_bound.svg", bound_chart(run)},
                                    {"chart_lights.svg", lights_chart(run)},
                                    {"chart_vertices.svg", vertices_chart(run)}})
    write_file(folder.file(name), chart_svg(chart, width, height, true));
  write_file(folder.file("index.html"), chart_page(run));
  folder.commit();

  if (command.scene.json) {
    print_result("{}", chart_json(run));
  } else if (!command.scene.quiet) {
    print_result("{:<28} {:>12} {:>12} {:>10} {:>10}\n", "method", "seconds", "vertices", "rmse/255",
                 "bound/255");
    for (const MethodRun& m : run.methods)
      print_result("{:<28} {:>12.3g} {:>12} {:>10.3f} {:>10.3f}\n", m.label(), m.all_threads.median,
                   group_digits(m.n_vertices), m.rmse * 255, round_up(m.max_bound * 255, 3));
    print_result("{}\n", (std::filesystem::path(command.folder) / "index.html").string());
  }
  return 0;
}

}  // namespace

void add_chart_command(CLI::App& app, Run& run) {
  auto command = std::make_shared<ChartCommand>();
  CLI::App& sub = *app.add_subcommand("chart", "speed against accuracy: time and error of every method");
  add_scene_options(sub, command->scene);
  add_camera_options(sub, command->camera);
  sub.remove_option(sub.get_option("--size"));  // The pictures have fixed sizes.
  sub.add_option("-o,--output", command->folder, "folder to write into; made if it is not there")->required();
  sub.add_option("--methods", command->methods,
                 fmt::format("methods to measure, of {}; default: all", fmt::join(chart_methods(), ", ")))
      ->delimiter(',')
      ->check(CLI::IsMember(chart_methods()));
  sub.add_option("--budget-seconds", command->budget_seconds, "nothing new is measured after this long")
      ->check(above_zero())
      ->capture_default_str();
  sub.footer("Example: lambake chart bunny.ply --sun 0.4,1,0.3 -o out/chart --budget-seconds 30");
  sub.callback([command, &run] {
    run = [command](const std::string& command_line) { return chart_and_write(*command, command_line); };
  });
}

}  // namespace lambake::tool
