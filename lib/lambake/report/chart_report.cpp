#include "lambake/report/chart_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "lambake/report/json_parts.h"
#include "lambake/report/page_frame.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

using Json = nlohmann::ordered_json;

Json timing_json(const Timing& t) {
  return {{"median", t.median}, {"low_quartile", t.low}, {"high_quartile", t.high}, {"repeats", t.repeats}};
}

Json timings_json(const Timing& one_thread, const Timing& all_threads) {
  return {{"one_thread", timing_json(one_thread)}, {"all_threads", timing_json(all_threads)}};
}

ChartPoint point_of(const Timing& time, double y, std::string label) {
  return {time.median, y, time.low, time.high, std::move(label)};
}

/// What stands beside a point: the mark tells `sample` from the rest, what it was varied by is the news.
std::string label_of(const MethodRun& m) {
  return m.method == "sample" && !m.variant.empty() ? m.variant : m.label();
}

/// Whether this is what `auto` took.
bool is_chosen(const ChartRun& run, const MethodRun& m) {
  return m.method == run.chosen_method && (m.variant.empty() || m.variant == "1/255");
}

/// The number of the colour and shape of a method, and of pictures that are lit per pixel, in every chart.
std::size_t kind_of(const std::string& method) {
  constexpr const char* methods[] = {"sample",  "face",    "adaptive", "least-squares",
                                     "average", "uniform", "per pixel"};
  return static_cast<std::size_t>(std::find(std::begin(methods), std::end(methods), method) - methods);
}

/// In steps of 1/255. What rounding leaves of 0 is 0: it would stretch an axis by powers of ten.
double steps(double error) {
  return error * 255 < 1e-6 ? 0 : error * 255;
}

/// One series per method, in the order of the run, of the runs that have a y.
std::vector<ChartSeries> series_by_method(
    const ChartRun& run, const std::function<std::optional<ChartPoint>(const MethodRun&)>& point) {
  std::vector<ChartSeries> all;
  for (const MethodRun& m : run.methods) {
    std::optional<ChartPoint> p = point(m);
    if (!p) continue;
    p->is_emphasised = is_chosen(run, m);
    auto series =
        std::find_if(all.begin(), all.end(), [&](const ChartSeries& s) { return s.name == m.method; });
    if (series == all.end())
      series = all.insert(all.end(), ChartSeries{.name = m.method, .points = {}, .kind = kind_of(m.method)});
    series->points.push_back(*p);
  }
  return all;
}

std::string size_of(const FrameRun& frame) {
  return fmt::format("{}×{}", frame.width, frame.height);
}

constexpr const char* bound_axis = "certified largest error, on screen, steps of 1/255";

/// Time of a bake over an error, of the methods that have it; pictures lit per pixel beside.
Chart time_chart(const ChartRun& run, const char* id, const char* title, const char* error_axis,
                 const std::function<std::optional<double>(const MethodRun&)>& error) {
  Chart chart{
      .id = id,
      .title = title,
      .x = {fmt::format("time of a bake on {} thread{}", run.n_threads, run.n_threads == 1 ? "" : "s"),
            duration},
      .y = {error_axis, short_number},
      .has_front = true};
  chart.series = series_by_method(run, [&](const MethodRun& m) -> std::optional<ChartPoint> {
    const std::optional<double> e = error(m);
    if (!e) return std::nullopt;
    return point_of(m.all_threads, steps(*e), label_of(m));
  });
  ChartSeries frames{
      .name = "per pixel, one picture", .points = {}, .is_compared = false, .kind = kind_of("per pixel")};
  for (const FrameRun& f : run.frames) frames.points.push_back(point_of(f.per_fragment, 0, size_of(f)));
  if (!frames.points.empty()) chart.series.push_back(std::move(frames));
  return chart;
}

/// A field of RFC 4180.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// The number of lights at which both cost the same, between two measured ones; none if one is always
/// cheaper.
std::optional<ChartPoint> crossing(const ChartRun& run) {
  for (std::size_t i = 0; i + 1 < run.lights.size(); ++i) {
    const LightsRun &a = run.lights[i], &b = run.lights[i + 1];
    const double da = std::log(a.per_vertex.median / a.per_fragment.median);
    const double db = std::log(b.per_vertex.median / b.per_fragment.median);
    if (da == db || (da < 0) == (db < 0)) continue;
    const double t = da / (da - db);
    const auto between = [t](double u, double v) {
      return std::exp((1 - t) * std::log(u) + t * std::log(v));
    };
    return ChartPoint{.x = between(static_cast<double>(a.n_lights), static_cast<double>(b.n_lights)),
                      .y = between(a.per_vertex.median, b.per_vertex.median),
                      .is_emphasised = true};
  }
  return std::nullopt;
}

/// The first run of which something holds, if there is one.
template <typename Predicate>
const MethodRun* find_run(const ChartRun& run, const Predicate& is_it) {
  const auto it = std::find_if(run.methods.begin(), run.methods.end(), is_it);
  return it == run.methods.end() ? nullptr : &*it;
}

/// That by `sample` with the scene's normals.
const MethodRun* find_sample(const ChartRun& run) {
  return find_run(run, [](const MethodRun& m) { return m.method == "sample" && m.variant.empty(); });
}

/// When a bake has paid for itself.
std::string payback(const ChartRun& run) {
  const MethodRun* chosen = find_run(run, [&](const MethodRun& m) { return is_chosen(run, m); });
  const MethodRun* baker = chosen != nullptr ? chosen : find_sample(run);
  if (baker == nullptr || run.frames.empty())
    return fmt::format("Time against error of {} {} to light {}.", run.methods.size(),
                       in_number(run.methods.size(), "way[|s]"), run.input);
  const FrameRun& frame = run.frames.back();
  const double saved = frame.per_fragment.median - frame.per_vertex.median;
  const std::string pays =
      saved <= 0 ? "a picture costs the same either way"
                 : fmt::format("it saves {} on each picture of {}, so it has paid for itself after {}",
                               duration(saved), size_of(frame),
                               baker->all_threads.median <= saved
                                   ? std::string("the first")
                                   : fmt::format("{:.0f}", std::ceil(baker->all_threads.median / saved)));
  return fmt::format("Baking by {} takes {} and is typically off by {}; {}.", baker->label(),
                     duration(baker->all_threads.median), steps_of_255(baker->rmse), pays);
}

std::string header(const ChartRun& run) {
  std::string sentence = payback(run), more;
  if (!run.verdict.empty()) {
    more = fmt::format("<p>{} What the first sentence names is ringed in the charts.</p>\n",
                       escape_html(sentence));
    sentence = fmt::format("Within 1/255: {}.", run.verdict);
  }
  return fmt::format(
      "<p class=\"eyebrow\">{} · speed against accuracy</p>\n<h1>{}</h1>\n{}<ul class=\"facts\">\n"
      "<li>{}</li>\n<li>{}</li>\n<li>{}</li>\n<li>{}</li>\n</ul>\n",
      escape_html(run.input), escape_html(sentence), more, count_of(run.n_vertices, "vertex", "vertices"),
      count_of(run.n_triangles, "triangle", "triangles"), count_of(run.n_lights, "light", "lights"),
      count_of(run.n_threads, "thread", "threads"));
}

std::string chart_section(const Chart& chart, const std::string& text) {
  return fmt::format("{}<figure>\n{}<figcaption>{}</figcaption>\n</figure>\n</section>\n",
                     section_begin(chart.id, escape_html(chart.title)), responsive_chart_svg(chart), text);
}

std::string timing_cell(const Timing& t) {
  const std::string repeats =
      t.repeats == 1 ? "run once"
                     : fmt::format("{} to {}, {} repeats", duration(t.low), duration(t.high), t.repeats);
  return fmt::format("{}<small>{}</small>", duration(t.median), repeats);
}

std::string methods_section(const ChartRun& run) {
  std::vector<std::vector<std::string>> rows;
  for (const MethodRun& m : run.methods)
    rows.push_back({escape_html(m.label()), grouped(m.n_vertices), grouped(m.bytes),
                    timing_cell(m.one_thread), timing_cell(m.all_threads), steps_of_255(m.rmse),
                    steps_of_255(m.max_sampled), bound_of_255(m.max_bound)});
  return section_begin("methods", "The methods in numbers") +
         stacked_table({"Method", "Vertices", "Bytes", "One thread", "All threads", "RMSE", "Largest found",
                        "Certified"},
                       CellKind::number, rows) +
         "</section>\n";
}

std::string frames_section(const ChartRun& run) {
  if (run.frames.empty()) return {};
  std::vector<std::vector<std::string>> rows;
  for (const FrameRun& f : run.frames)
    rows.push_back({size_of(f), grouped(f.n_covered), timing_cell(f.per_vertex_one_thread),
                    timing_cell(f.per_vertex), timing_cell(f.per_fragment_one_thread),
                    timing_cell(f.per_fragment)});
  return section_begin("frames", "A picture, drawn both ways") +
         stacked_table({"Size",
                        "Lit pixels",
                        "Per vertex, one thread",
                        {"all threads", "Per vertex, all threads"},
                        "Per pixel, one thread",
                        {"all threads", "Per pixel, all threads"}},
                       CellKind::number, rows) +
         "</section>\n";
}

}  // namespace

std::string chart_json(const ChartRun& run) {
  Json json = {{"input", run.input},         {"command", run.command},       {"version", run.version},
               {"vertices", run.n_vertices}, {"triangles", run.n_triangles}, {"lights", run.n_lights},
               {"threads", run.n_threads}};
  if (!run.verdict.empty()) json["auto"] = {{"verdict", run.verdict}, {"method", run.chosen_method}};
  json["methods"] = Json::array();
  for (const MethodRun& m : run.methods)
    json["methods"].push_back(
        {{"method", m.method},
         {"variant", m.variant},
         {"vertices", m.n_vertices},
         {"triangles", m.n_triangles},
         {"bytes", m.bytes},
         {"seconds", timings_json(m.one_thread, m.all_threads)},
         {"surface_display",
          {{"rmse", m.rmse}, {"max_sampled", m.max_sampled}, {"max_bound", m.max_bound}}}});
  json["pictures"] = Json::array();
  for (const FrameRun& f : run.frames)
    json["pictures"].push_back({{"width", f.width},
                                {"height", f.height},
                                {"lit_pixels", f.n_covered},
                                {"per_vertex", timings_json(f.per_vertex_one_thread, f.per_vertex)},
                                {"per_fragment", timings_json(f.per_fragment_one_thread, f.per_fragment)}});
  json["over_lights"] = Json::array();
  for (const LightsRun& l : run.lights)
    json["over_lights"].push_back({{"lights", l.n_lights},
                                   {"per_vertex", timing_json(l.per_vertex)},
                                   {"per_fragment", timing_json(l.per_fragment)}});
  json["left_out"] = run.left_out;
  json["seconds"] = run.seconds;
  return json_text(json) + '\n';
}

std::string chart_csv(const ChartRun& run) {
  std::string csv =
      "method,variant,vertices,triangles,bytes,seconds_one_thread,seconds_all_threads,low_quartile,"
      "high_quartile,repeats,rmse_display,max_sampled_display,max_bound_display\r\n";
  for (const MethodRun& m : run.methods)
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\r\n", csv_field(m.method),
                       csv_field(m.variant), m.n_vertices, m.n_triangles, m.bytes, m.one_thread.median,
                       m.all_threads.median, m.all_threads.low, m.all_threads.high, m.all_threads.repeats,
                       m.rmse, m.max_sampled, m.max_bound);
  for (const FrameRun& f : run.frames)
    for (const auto& [name, one, time] : {std::tuple{"per vertex", f.per_vertex_one_thread, f.per_vertex},
                                          {"per pixel", f.per_fragment_one_thread, f.per_fragment}})
      csv += fmt::format("picture {},{}x{},,,,{},{},{},{},{},,,\r\n", name, f.width, f.height, one.median,
                         time.median, time.low, time.high, time.repeats);
  return csv;
}

Chart speed_chart(const ChartRun& run) {
  return time_chart(run, "speed", "Time against typical error",
                    "RMSE on the surface, on screen, steps of 1/255",
                    [](const MethodRun& m) { return std::optional(m.rmse); });
}

Chart bound_chart(const ChartRun& run) {
  return time_chart(run, "bound", "Time against largest error", bound_axis, [](const MethodRun& m) {
    return std::isfinite(m.max_bound) ? std::optional(m.max_bound) : std::nullopt;
  });
}

Chart lights_chart(const ChartRun& run) {
  Chart chart{.id = "over-lights",
              .title = "Time over the number of lights",
              .x = {"lamps around the model", short_number},
              .y = {"time", duration}};
  ChartSeries vertex{"per vertex: one bake", {}, true},
      fragment{"per pixel: one picture of 1280×720", {}, true};
  for (const LightsRun& l : run.lights) {
    const auto n = static_cast<double>(l.n_lights);
    vertex.points.push_back({n, l.per_vertex.median});
    fragment.points.push_back({n, l.per_fragment.median});
  }
  chart.series = {std::move(vertex), std::move(fragment)};
  if (std::optional<ChartPoint> p = crossing(run)) {
    p->label = fmt::format("equal at {} lights", short_number(std::round(p->x)));
    chart.series.push_back({"crossing", {*p}});
  }
  return chart;
}

Chart vertices_chart(const ChartRun& run) {
  Chart chart{.id = "over-vertices",
              .title = "Largest error over the number of vertices",
              .x = {"vertices", short_number},
              .y = {bound_axis, short_number},
              .has_front = true};
  chart.series = series_by_method(run, [](const MethodRun& m) -> std::optional<ChartPoint> {
    // Normals and storage change the error, not the number of vertices.
    if (!std::isfinite(m.max_bound) || m.variant.starts_with("normals") || m.variant.starts_with("stored"))
      return std::nullopt;
    return ChartPoint{static_cast<double>(m.n_vertices), steps(m.max_bound), 0, 0, m.label()};
  });
  // Where the light is smooth the error falls with h² ~ 1/V, at a kink with h ~ 1/√V.
  const MethodRun* sample = find_sample(run);
  double most = 0;
  for (const MethodRun& m : run.methods) most = std::max(most, static_cast<double>(m.n_vertices));
  if (sample != nullptr && std::isfinite(sample->max_bound) && sample->max_bound > 0) {
    const double v = static_cast<double>(sample->n_vertices), e = sample->max_bound * 255, end = 1.5 * most;
    if (end > v) {
      chart.guides.push_back({v, e, end, e * v / end, "h²: smooth light"});
      chart.guides.push_back({v, e, end, e * std::sqrt(v / end), "h: at a terminator"});
    }
  }
  return chart;
}

std::string chart_page(const ChartRun& run) {
  std::string main = chart_section(
      speed_chart(run),
      std::string(
          "Left is faster, lower is closer to light per pixel. Filled marks are on the front: nothing "
          "else measured is both faster and closer. The bars are the quartiles of the repeats.") +
          (run.frames.empty() ? "" : " At 0: what a picture costs that is lit per pixel."));
  const bool has_bound = std::any_of(run.methods.begin(), run.methods.end(),
                                     [](const MethodRun& m) { return std::isfinite(m.max_bound); });
  if (has_bound)
    main += chart_section(
        bound_chart(run),
        "The same with the largest error anywhere on the surface, certified: it is never below the truth.");
  if (!run.lights.empty()) {
    const std::optional<ChartPoint> p = crossing(run);
    const LightsRun& last = run.lights.back();
    main += chart_section(
        lights_chart(run),
        p ? fmt::format("Both cost the same at about {} lights.", short_number(std::round(p->x)))
          : fmt::format("The lines do not cross: {} is cheaper for every number measured.",
                        last.per_vertex.median < last.per_fragment.median ? "one bake" : "one picture"));
  }
  if (has_bound)
    main += chart_section(
        vertices_chart(run),
        "Where light is smooth an even finer mesh errs with h², the square of its edge length; across "
        "a terminator only with h. Cutting there beats both.");
  main += methods_section(run) + frames_section(run);
  std::string time = duration(run.seconds);
  if (!run.left_out.empty())
    time += "; the budget left out " + escape_html(fmt::format("{}", fmt::join(run.left_out, "; ")));
  main += made_section(run.command, run.version, time);
  return page_frame("chart", run.input, header(run), main);
}

}  // namespace lambake
