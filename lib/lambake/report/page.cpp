#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <tuple>

#include "lambake/report/page_frame.h"
#include "lambake/report/page_pictures.h"
#include "lambake/report/report.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

/// Of the pixels compared, of which there is one at least.
double share_over_1_255(const ImageError& image) {
  return static_cast<double>(image.pixels_over_1_255) / static_cast<double>(image.pixels);
}

/// The sentence that the page opens with, from the numbers on screen.
std::string verdict(const Comparison& c) {
  constexpr double visible = 1.0 / 255;
  const ImageError& image = c.image_display;
  const double largest = std::max(image.max, c.surface_display.max_sampled);
  const bool is_dark = std::any_of(c.findings.begin(), c.findings.end(),
                                   [](const Finding& finding) { return finding.code == "too_dark_to_see"; });
  if (is_dark && largest <= visible)
    return "Nothing is to be seen, so nothing differs: all of it is too dark for a screen.";
  if (!c.verdict.empty()) {
    std::string sentence = c.verdict + ".";
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    return sentence;
  }
  if (c.max_bound_display && *c.max_bound_display <= visible)
    return fmt::format(
        "Per-vertex lighting is enough: nowhere on the surface is it more than {} away from "
        "per-pixel lighting, and that is certain.",
        // An upper bound still, and one that people can read.
        bound_of_255(*c.max_bound_display > 0 ? std::max(*c.max_bound_display, 0.01 / 255) : 0));
  if (largest <= visible)
    return fmt::format(
        "Per-vertex lighting is enough: no place was found where it is more than 1/255 away from "
        "per-pixel lighting; the largest difference is {}.",
        steps_of_255(largest));
  if (image.pixels == 0)
    return fmt::format(
        "The difference is visible: per-vertex and per-pixel lighting are up to {} apart on the surface; "
        "the picture does not show the model.",
        steps_of_255(largest));
  if (image.pixels_over_1_255 == 0)
    return fmt::format(
        "Seen from here per-vertex lighting is enough; elsewhere on the surface it differs from "
        "per-pixel lighting by up to {}.",
        steps_of_255(largest));
  return fmt::format(
      "The difference is visible: {} of the pixels lit per vertex are more than 1/255 away from per-pixel "
      "lighting, the worst place {}by {}{}{}.",
      percent(share_over_1_255(image)), c.surface_display.max_sampled > image.max ? "on the surface " : "",
      steps_of_255(largest), c.main_loss.empty() ? "" : "; most of it is ", c.main_loss);
}

/// The few numbers that people ask for first.
std::string tiles(const Comparison& c) {
  std::string html = "<dl class=\"tiles\">\n";
  const auto add = [&](const std::string& value, const char* meaning) {
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", meaning, value);
  };
  const ImageError& image = c.image_display;
  if (image.pixels > 0) {
    add(percent(share_over_1_255(image)), "of the pixels off by more than 1/255");
    add(steps_of_255(image.rmse), "typical difference in the picture (RMSE)");
  }
  add(steps_of_255(c.surface_display.max_sampled), "largest found on the surface");
  if (c.max_bound_display)
    add(bound_of_255(*c.max_bound_display), "largest possible anywhere, certified");
  else if (image.pixels > 0)
    add(steps_of_255(image.max), "largest in the picture");
  return html + "</dl>\n";
}

std::string header(const Comparison& c) {
  std::string html = fmt::format(
      "<p class=\"eyebrow\">{} · light per vertex against light per pixel</p>\n<h1>{}</h1>\n<ul "
      "class=\"facts\">\n",
      escape_html(c.input), escape_html(verdict(c)));
  const auto add = [&](const std::string& fact) { html += "<li>" + fact + "</li>\n"; };
  add(count_of(c.n_vertices, "vertex", "vertices"));
  add(count_of(c.n_triangles, "triangle", "triangles"));
  add(count_of(c.n_lights, "light", "lights"));
  add(fmt::format("method <b>{}</b>", escape_html(c.method)));
  add(fmt::format("normals <b>{}</b>", escape_html(c.normals)));
  if (c.n_triangles != c.n_scene_triangles)
    add(fmt::format("read with {}, {}", count_of(c.n_scene_vertices, "vertex", "vertices"),
                    count_of(c.n_scene_triangles, "triangle", "triangles")));
  return html + "</ul>\n" + tiles(c);
}

/// One table of numbers, in one colour space.
std::string numbers_table(const std::string& caption, const ImageError& image, const SurfaceError& surface,
                          const std::optional<double>& max_bound, std::string (*show)(double),
                          std::string (*show_bound)(double)) {
  std::string html = fmt::format("<table class=\"table\">\n<caption>{}</caption>\n{}", caption,
                                 table_head({"Measure", "picture", "surface"}, CellKind::number));
  const auto row = [&](const char* name, const char* meaning, const std::string& in_picture,
                       const std::string& on_surface) {
    html += fmt::format(
        "<tr><th scope=\"row\">{}<small>{}</small></th><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        name, meaning, in_picture, on_surface);
  };
  row("RMSE", "typical difference, large ones weigh more", show(image.rmse), show(surface.rmse));
  row("Mean size", "mean of |difference|", show(image.mae), show(surface.mae));
  row("Mean", "below 0: per vertex is darker", show(image.mean), show(surface.mean));
  row("Largest found", "the worst pixel, the worst point met", show(image.max), show(surface.max_sampled));
  if (max_bound) row("Largest possible", "certified: it is nowhere more", "–", show_bound(*max_bound));
  row("99 % are below", "by their worst channel", show(image.p99), "–");
  row("PSNR", "20·log₁₀(1/RMSE)",
      std::isinf(image.psnr_db) ? "∞ (equal)" : short_number(image.psnr_db) + " dB", "–");
  return html + "</tbody>\n</table>\n";
}

std::string numbers_section(const Comparison& c) {
  return fmt::format(
      "{}<p class=\"soft\">The picture shows what one camera sees ({}); the surface is measured by area, "
      "from no camera and with hidden places included. 0 is black, 1 is white.</p>\n<div "
      "class=\"columns\">\n{}{}</div>\n</section>\n",
      section_begin("numbers", "The numbers"),
      c.n_views == 1 ? std::string("one view") : fmt::format("{} views taken together", c.n_views),
      numbers_table("On screen: sRGB-encoded, clamped to 0…1; what the eye gets", c.image_display,
                    c.surface_display, c.max_bound_display, steps_of_255, bound_of_255),
      numbers_table("Linear: amounts of light as computed", c.image_linear, c.surface_linear,
                    c.max_bound_linear, short_number, short_bound));
}

/// What each step from the light to the file adds.
std::string shares_section(const Comparison& c) {
  const double largest = std::max({c.shares.interpolation, c.shares.clipping, c.shares.quantisation});
  if (!(largest > 0)) return {};
  std::string html = section_begin("steps", "What makes the difference") +
                     "<table class=\"table lights\">\n" +
                     table_head({"Step", "its own RMSE, linear"}, CellKind::text);
  using Share = std::tuple<const char*, const char*, double>;
  for (const auto& [name, meaning, value] :
       {Share{"Interpolation", "light known at the vertices only", c.shares.interpolation},
        Share{"Clipping", "colours above 1 cut off by the file", c.shares.clipping},
        Share{"Quantisation", "colours rounded to the steps of the file", c.shares.quantisation}})
    html += fmt::format("<tr><th scope=\"row\">{}<small>{}</small></th>{}</tr>\n", name, meaning,
                        bar_cell(100 * value / largest, short_number(value)));
  return html + "</tbody>\n</table>\n</section>\n";
}

/// What the methods would cost and leave, where one was chosen by itself.
std::string trials_section(const Comparison& c) {
  if (c.trials.empty()) return {};
  std::string html = section_begin("trials", "The methods that were tried");
  if (c.tolerance_space == ErrorSpace::linear)
    html += "<p>Differences of linear values, as the tolerance is meant.</p>\n";
  std::vector<std::vector<std::string>> rows;
  for (const MethodTrial& t : c.trials)
    rows.push_back({name_of(t.method), grouped(t.n_vertices), grouped(t.bytes), duration(t.seconds),
                    steps_of_255(t.rmse), steps_of_255(t.max_found),
                    bound_of_255(t.max_bound) + (t.is_certified ? "; within the tolerance" : "")});
  return html +
         stacked_table({"Method", "Vertices", "Bytes", "Time", "RMSE", "Largest found", "Certified"},
                       CellKind::number, rows) +
         "</section>\n";
}

std::string worst_section(const Comparison& c) {
  const std::vector<SurfacePlace>& worst = c.surface_display.worst;
  if (worst.empty()) return {};
  const auto vector = [](const glm::dvec3& v) {
    // What rounding leaves beside a 1 is 0 to a reader.
    const auto number = [&](double x) { return short_number(std::abs(x) < 1e-9 * glm::length(v) ? 0 : x); };
    return fmt::format("{}, {}, {}", number(v.x), number(v.y), number(v.z));
  };
  const double size = std::sqrt(c.surface_display.area);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < worst.size(); ++i) {
    const SurfacePlace& place = worst[i];
    // The faces on both sides of an edge meet the same place.
    const auto is_here = [&](const SurfacePlace& other) {
      return glm::distance(other.position, place.position) <=
             1e-6 * size + 1e-14 * glm::length(place.position);
    };
    if (std::any_of(worst.begin(), worst.begin() + static_cast<std::ptrdiff_t>(i), is_here)) continue;
    std::string faces = grouped(place.source_face);
    for (std::size_t j = i + 1; j < worst.size(); ++j)
      if (is_here(worst[j])) faces += ", " + grouped(worst[j].source_face);
    const bool is_named = place.light && *place.light < c.light_names.size();
    rows.push_back({steps_of_255(place.error), faces, vector(place.barycentrics), vector(place.position),
                    is_named ? escape_html(c.light_names[*place.light]) : "–"});
  }
  return section_begin("worst", "The worst places on the surface") +
         "<p class=\"soft\">Of all of it, also what no picture shows. Faces are counted from 0, barycentrics "
         "are of the first one's corners. <code>surface_error.ply</code> beside this page has each triangle "
         "in the colour of its worst place, on the scale of the map above.</p>\n" +
         stacked_table(
             {"Off by", "Face", "Barycentrics", "Position", {"Light that causes most of it", "Light"}},
             CellKind::text, rows) +
         "</section>\n";
}

/// The lights that matter most, with bars: their share of the light and of the interpolation error.
std::string lights_section(const Comparison& c) {
  if (c.light_shares.empty()) return {};
  std::vector<std::size_t> order(c.light_shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto weight = [&](std::size_t i) { return c.light_shares[i].error + c.light_shares[i].light; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return weight(a) > weight(b); });
  constexpr std::size_t n_shown = 8;

  std::string html =
      section_begin("lights", "Each light's share") + "<table class=\"table lights\">\n" +
      table_head({"Light", "of the light on the surface", "of the error that interpolating makes"},
                 CellKind::text);
  const auto row = [&](const std::string& name, const LightShare& share) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>{}{}</tr>\n", name,
                        bar_cell(100 * share.light, percent(share.light)),
                        bar_cell(100 * share.error, percent(share.error)));
  };
  LightShare rest;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const LightShare& share = c.light_shares[order[i]];
    if (i < n_shown)
      row(escape_html(c.light_names[order[i]]), share);
    else
      rest.light += share.light, rest.error += share.error;
  }
  if (order.size() > n_shown) row(fmt::format("{} others", grouped(order.size() - n_shown)), rest);
  return html + "</tbody>\n</table>\n</section>\n";
}

std::string findings_section(const Comparison& c) {
  std::string items;
  for (const Finding& finding : c.findings)
    items += fmt::format("<li><b>{}</b> {}</li>\n", grouped(finding.count), escape_html(finding.text));
  if (c.seen_from_behind > 0)
    items += fmt::format("<li>{} the side of a face that its normal is not on</li>\n",
                         count_of(c.seen_from_behind, "pixel shows", "pixels show"));
  return section_begin("findings", "What was noticed") +
         (items.empty() ? "<p>Nothing odd.</p>\n" : "<ul class=\"plain\">\n" + items + "</ul>\n") +
         "</section>\n";
}

/// "1.2 s (read 200 ms, bake 1 s)".
std::string times(const Comparison& c) {
  std::string stages;
  double total = 0;
  for (const auto& [stage, seconds] : c.seconds) {
    stages += fmt::format("{}{} {}", stages.empty() ? "" : ", ", escape_html(stage), duration(seconds));
    total += seconds;
  }
  return stages.empty() ? std::string() : fmt::format("{} ({})", duration(total), stages);
}

}  // namespace

std::string report_page(const Comparison& c) {
  return page_frame("compare", c.input, header(c),
                    picture_sections(c) + trials_section(c) + numbers_section(c) + shares_section(c) +
                        lights_section(c) + worst_section(c) + findings_section(c) +
                        made_section(c.command, c.version, times(c)));
}

}  // namespace lambake
