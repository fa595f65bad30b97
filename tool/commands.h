#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

/// One file per command. Each adds its options to `app` and sets `run` to what the command does; `run` gets
/// the command line for the report.
namespace lambake::tool {

using Run = std::function<int(const std::string& command_line)>;

void add_bake_command(CLI::App& app, Run& run);
void add_render_command(CLI::App& app, Run& run);
void add_compare_command(CLI::App& app, Run& run);
void add_chart_command(CLI::App& app, Run& run);
void add_info_command(CLI::App& app, Run& run);

}  // namespace lambake::tool
