#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lambake/core/error.h"
#include "lambake/core/version.h"
#include "signals.h"

namespace {

/// The command line as a shell would take it again.
std::string quoted_command_line(int argc, char** argv) {
  std::string line = "lambake";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool is_plain =
        !word.empty() && word.find_first_not_of(
                             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                             "_-+=./,:@%") == std::string::npos;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    line += ' ' + (is_plain ? word : quoted + '\'');
  }
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  // A standard stream that is closed would be the next file that is opened.
  for (int stream = 0; stream <= 2; ++stream)
    if (::fcntl(stream, F_GETFD) == -1 && ::open("/dev/null", O_RDWR) == -1) return 3;
  lambake::tool::prepare_for_signals();
  constexpr int usage_error = 2, our_fault = 5;
  CLI::App app{
      "lambake: Lambertian light per vertex, per pixel, and the difference.\n"
      "Bakes light into vertex colours, renders the same scene lit per pixel, and tells how far the two are "
      "apart."};
  app.name("lambake");
  app.set_version_flag("--version", "lambake " + lambake::version() + "\n" + lambake::build_info());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 a threshold of --fail-above was exceeded; 2 usage; 3 a file could not be read "
      "or\n"
      "written; 4 the scene cannot be processed; 5 a fault of lambake.\n"
      "`lambake COMMAND --help` shows a command's options and an example.");
  lambake::tool::Run run;
  lambake::tool::add_bake_command(app, run);
  lambake::tool::add_render_command(app, run);
  lambake::tool::add_compare_command(app, run);
  lambake::tool::add_chart_command(app, run);
  lambake::tool::add_info_command(app, run);

  const auto fail = [](const std::string& message, int exit_code) {
    lambake::tool::print_error(fmt::format("lambake: {}\n", lambake::tool::on_one_line(message)));
    return exit_code;
  };
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      app.exit(error);
      return std::cout.flush() ? 0 : fail("standard output cannot be written", 3);
    }
    std::vector<std::string> commands;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
      commands.push_back(command->get_name());
    const bool is_unknown = argc > 1 && argv[1][0] != '-' &&
                            std::find(commands.begin(), commands.end(), argv[1]) == commands.end();
    if (argc < 2 || is_unknown)
      return fail(
          fmt::format("expected a command ({}), found {} (see lambake --help)", fmt::join(commands, ", "),
                      is_unknown ? fmt::format("\"{}\"", argv[1]) : "none"),
          usage_error);
    const auto given = app.get_subcommands();
    const std::string help =
        given.empty() ? "lambake --help" : fmt::format("lambake {} --help", given[0]->get_name());
    if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr)
      return fail(fmt::format("{} (see {})", error.what(), help), usage_error);
    const std::vector<std::string> extras = app.remaining(true);
    const bool are_numbers = std::all_of(extras.begin(), extras.end(), [](const std::string& word) {
      return word.find_first_not_of("+-.,0123456789eE") == std::string::npos;
    });
    return fail(
        fmt::format("expected options, found {}{} (see {})", fmt::join(extras, " "),
                    are_numbers
                        ? "; numbers that belong together have commas between them, as in --sun 0.4,1,0.3"
                        : "",
                    help),
        usage_error);
  }
  try {
    const int exit_code = run(quoted_command_line(argc, argv));
    lambake::tool::flush_results();
    return exit_code;
  } catch (const lambake::Error& error) {
    return fail(error.what(), error.exit_code());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.what(), 3);
  } catch (const std::bad_alloc&) {
    return fail("not enough memory for this scene", 4);
  } catch (const std::exception& error) {
    return fail(fmt::format("internal error: {}", error.what()), our_fault);
  }
}
