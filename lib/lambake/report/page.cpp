#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "lambake/io/image_file.h"
#include "lambake/report/charts.h"
#include "lambake/report/difference.h"
#include "lambake/report/page_frame.h"
#include "lambake/report/report.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

std::string data_uri(const Picture& picture) {
  return "data:image/png;base64," + base64(encode_png(picture));
}

/// The sentence that the page opens with, from the numbers on screen.
std::string verdict(const Comparison& c) {
  if (!c.verdict.empty()) {
    std::string sentence = c.verdict + ".";
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
    return sentence;
  }
  constexpr double visible = 1.0 / 255;
  const ImageError& image = c.image_display;
  const double over = image.pixels == 0
                          ? 0
                          : static_cast<double>(image.pixels_over_1_255) / static_cast<double>(image.pixels);
  const double largest = std::max(image.max, c.surface_display.max_sampled);
  if (c.max_bound_display && *c.max_bound_display <= visible)
    return fmt::format(
        "Per-vertex lighting is enough: nowhere on the surface is it more than {} away from "
        "per-pixel lighting, and that is certain.",
        bound_of_255(*c.max_bound_display));
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
      "lighting, the worst place by {}.",
      percent(over), steps_of_255(largest));
}

/// The few numbers that people ask for first.
std::string tiles(const Comparison& c) {
  std::string html = "<dl class=\"tiles\">\n";
  const auto add = [&](const std::string& value, const char* meaning) {
    html += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", meaning, value);
  };
  const ImageError& image = c.image_display;
  if (image.pixels > 0)
    add(percent(static_cast<double>(image.pixels_over_1_255) / static_cast<double>(image.pixels)),
        "of the pixels off by more than 1/255");
  add(steps_of_255(image.rmse), "typical difference in the picture (RMSE)");
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

/// A rectangle of pixels.
struct Part {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
};

Picture crop(const Picture& picture, const Part& part) {
  Picture out{part.width, part.height, {}};
  out.pixels.reserve(static_cast<std::size_t>(part.width) * part.height);
  for (std::uint32_t row = part.y; row < part.y + part.height; ++row) {
    const auto begin = picture.pixels.begin() + static_cast<std::ptrdiff_t>(row) * picture.width + part.x;
    out.pixels.insert(out.pixels.end(), begin, begin + part.width);
  }
  return out;
}

/// The same of a picture of the model: its background, which is black as what gets no light is, in the colour
/// of the heat map's.
Picture crop_of_model(const Picture& picture, const Visibility& visibility, const Part& part) {
  Picture out = crop(picture, part);
  for (std::size_t i = 0; i < out.pixels.size(); ++i) {
    const std::size_t x = part.x + i % part.width, y = part.y + i / part.width;
    if (visibility.triangles[y * visibility.width + x] == no_triangle) out.pixels[i] = to_linear(uncovered);
  }
  return out;
}

/// The interval of `length` around `[low, high]`, moved and shortened into [0, end).
std::pair<std::uint32_t, std::uint32_t> interval(std::uint32_t low, std::uint32_t high, std::uint32_t length,
                                                 std::uint32_t end) {
  length = std::min(length, end);
  const std::uint32_t middle = (low + high) / 2;
  const std::uint32_t begin = std::min(middle - std::min(middle, length / 2), end - length);
  return {begin, length};
}

/// The part of the picture that the model covers with a little around it, not narrower than 4:3: most of an
/// automatically framed picture is background.
Part covered_part(const Visibility& visibility) {
  std::uint32_t x0 = visibility.width, y0 = visibility.height, x1 = 0, y1 = 0;
  for (std::size_t i = 0; i < visibility.triangles.size(); ++i) {
    if (visibility.triangles[i] == no_triangle) continue;
    const auto x = static_cast<std::uint32_t>(i % visibility.width),
               y = static_cast<std::uint32_t>(i / visibility.width);
    x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  if (x0 > x1) return {0, 0, visibility.width, visibility.height};
  const std::uint32_t border = std::max(x1 - x0, y1 - y0) / 12 + 2;
  const auto [y, height] = interval(y0, y1, y1 - y0 + 2 * border, visibility.height);
  const auto [x, width] = interval(x0, x1, std::max(x1 - x0 + 2 * border, height * 4 / 3), visibility.width);
  return {x, y, width, height};
}

/// What the sections share: the differences of the first view, their scale, the part that is shown, the worst
/// pixels.
struct Differences {
  double scale = 0;
  Picture map;  ///< Whole.
  Part shown;
  std::uint32_t zoom_size = 0;  ///< Pixels a side.
  std::vector<WorstPixel> worst;
};

Differences find_differences(const Comparison& c) {
  Differences d;
  const std::vector<float> values = screen_difference(c.per_vertex, c.per_fragment, c.visibility);
  d.scale = scale_of(values, c.visibility);
  d.map = color_difference(values, c.visibility, d.scale);
  d.shown = covered_part(c.visibility);
  d.zoom_size = std::min({48U, c.per_vertex.width, c.per_vertex.height});
  d.worst = worst_pixels(values, c.per_vertex.width, 4, d.zoom_size);
  return d;
}

std::string slider_section(const Comparison& c, const Part& shown) {
  return fmt::format(
      R"(<section class="slider" aria-labelledby="pictures">
<h2 id="pictures">The two pictures</h2>
<figure>
<div class="viewer" style="--w: {width}; --h: {height}">
<div class="stage">
<img class="left" data-layer="vertex" data-name="per vertex" width="{width}" height="{height}" draggable="false" alt="{input} with the light computed at its vertices and interpolated" src="{vertex}">
<img class="right" data-layer="fragment" data-name="per pixel" width="{width}" height="{height}" draggable="false" alt="{input} with the light computed at every pixel" src="{fragment}">
<img data-layer="difference" data-name="difference" width="{width}" height="{height}" draggable="false" alt="" hidden>
</div>
<div class="tags" aria-hidden="true"><span class="tag-left">per vertex</span><span class="tag-right">per pixel</span></div>
<input type="range" min="0" max="100" step="0.5" value="50" aria-label="Line between the two pictures">
</div>
<fieldset class="choices" hidden>
<legend>Compare</legend>
<label><input type="radio" name="pair" data-left="vertex" data-right="fragment" checked>per vertex and per pixel</label>
<label><input type="radio" name="pair" data-left="vertex" data-right="difference">per vertex and difference</label>
<label><input type="radio" name="pair" data-left="fragment" data-right="difference">per pixel and difference</label>
</fieldset>
<figcaption>The same view, lit twice: at the vertices and interpolated between them, and at every pixel. Grey is background; black gets no light. <span class="screen">Drag the line, or use the arrow keys on the slider.</span></figcaption>
</figure>
</section>
)",
      fmt::arg("width", shown.width), fmt::arg("height", shown.height),
      fmt::arg("input", escape_html(c.input)),
      fmt::arg("vertex", data_uri(crop_of_model(c.per_vertex, c.visibility, shown))),
      fmt::arg("fragment", data_uri(crop_of_model(c.per_fragment, c.visibility, shown))));
}

std::string difference_section(const Comparison& c, const Differences& differences) {
  const Part& shown = differences.shown;
  std::string marks;
  for (std::size_t i = 0; i < differences.worst.size(); ++i)
    marks += fmt::format(
        "<a class=\"mark\" href=\"#zoom-{0}\" aria-label=\"Zoom {0}\" "
        "style=\"left:{1:.3f}%;top:{2:.3f}%\">{0}</a>\n",
        i + 1, 100 * (differences.worst[i].x - shown.x + 0.5) / shown.width,
        100 * (differences.worst[i].y - shown.y + 0.5) / shown.height);
  return fmt::format(
      R"(<section class="columns" aria-label="The difference">
<figure>
<h2>Where they differ</h2>
<div class="frame"><img id="difference" width="{width}" height="{height}" alt="Heat map of the difference between the two pictures; the scale ends at {scale}" src="{map}">
{marks}</div>
<div class="legend" aria-hidden="true"><span>−{scale}<small>per vertex darker</small></span><i style="background: {gradient}"></i><span>+{scale}<small>per vertex brighter</small></span></div>
<figcaption>Per vertex minus per pixel, as a screen shows it, in the channel that differs most. Blue: per vertex is darker. White: no difference. Red: per vertex is brighter. Larger differences than ±{scale} have the colour of the end.</figcaption>
</figure>
<figure>
<h2>How many pixels differ by how much</h2>
{histogram}<figcaption>{over} of {pixels} pixels are off by more than 1/255, the smallest step of an ordinary screen. Each line upwards is ten times as many pixels.</figcaption>
</figure>
</section>
)",
      fmt::arg("width", shown.width), fmt::arg("height", shown.height),
      fmt::arg("scale", steps_of_255(differences.scale)),
      fmt::arg("map", data_uri(crop(differences.map, shown))), fmt::arg("marks", marks),
      fmt::arg("gradient", diverging_gradient_css()),
      fmt::arg("histogram", histogram_svg(c.image_display.histogram)),
      fmt::arg("over", grouped(c.image_display.pixels_over_1_255)),
      fmt::arg("pixels", grouped(c.image_display.pixels)));
}

std::string zooms_section(const Comparison& c, const Differences& differences) {
  if (differences.worst.empty()) return {};
  const std::uint32_t size = differences.zoom_size;
  std::string html =
      "<section aria-labelledby=\"zooms\">\n<h2 id=\"zooms\">The worst places of the picture, enlarged</h2>\n"
      "<div class=\"columns\">\n";
  for (std::size_t i = 0; i < differences.worst.size(); ++i) {
    const WorstPixel& worst = differences.worst[i];
    const Part part{interval(worst.x, worst.x, size, differences.map.width).first,
                    interval(worst.y, worst.y, size, differences.map.height).first, size, size};
    html += fmt::format("<figure class=\"zoom\" id=\"zoom-{}\">\n<div class=\"crops\">\n", i + 1);
    for (const auto& [name, picture] : {std::pair<const char*, const Picture*>{"per vertex", &c.per_vertex},
                                        {"per pixel", &c.per_fragment},
                                        {"difference", &differences.map}})
      html += fmt::format(
          "<div><img width=\"{0}\" height=\"{0}\" alt=\"Zoom {1}, {2}\" src=\"{3}\"><span>{2}</span></div>\n",
          size, i + 1, name, data_uri(crop_of_model(*picture, c.visibility, part)));
    html += fmt::format(
        "</div>\n<figcaption><b>{}</b> Per vertex is {} by <b>{}</b> at column {}, row "
        "{}.</figcaption>\n</figure>\n",
        i + 1, worst.difference < 0 ? "darker" : "brighter", steps_of_255(std::abs(worst.difference)),
        worst.x, worst.y);
  }
  return html + "</div>\n</section>\n";
}

/// One table of numbers, in one colour space.
std::string numbers_table(const std::string& caption, const ImageError& image, const SurfaceError& surface,
                          const std::optional<double>& max_bound, std::string (*show)(double),
                          std::string (*show_bound)(double)) {
  std::string html = fmt::format(
      "<table class=\"table\">\n<caption>{}</caption>\n<thead><tr><th scope=\"col\">Measure</th>"
      "<th scope=\"col\" class=\"n\">picture</th><th scope=\"col\" "
      "class=\"n\">surface</th></tr></thead>\n<tbody>\n",
      caption);
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
      "<section aria-labelledby=\"numbers\">\n<h2 id=\"numbers\">The numbers</h2>\n<p class=\"soft\">The "
      "picture shows "
      "what one camera sees ({}); the surface is measured by area, from no camera and with hidden places "
      "included. 0 is black, 1 is white.</p>\n<div class=\"columns\">\n{}{}</div>\n</section>\n",
      c.n_views == 1 ? std::string("one view") : fmt::format("{} views taken together", c.n_views),
      numbers_table("On screen: sRGB-encoded, clamped to 0…1; what the eye gets", c.image_display,
                    c.surface_display, c.max_bound_display, steps_of_255, bound_of_255),
      numbers_table("Linear: amounts of light as computed", c.image_linear, c.surface_linear,
                    c.max_bound_linear, short_number, short_bound));
}

/// What each step from the light to the file adds.
std::string shares_section(const Comparison& c) {
  const double largest =
      std::max({c.shares.interpolation, c.shares.clipping.value_or(0), c.shares.quantisation.value_or(0)});
  if (!(largest > 0)) return {};
  std::string html =
      "<section aria-labelledby=\"steps\">\n<h2 id=\"steps\">What makes the difference</h2>\n<table "
      "class=\"table "
      "lights\">\n<thead><tr><th scope=\"col\">Step</th><th scope=\"col\">its own RMSE, "
      "linear</th></tr></thead>\n<tbody>\n";
  using Share = std::tuple<const char*, const char*, std::optional<double>>;
  for (const auto& [name, meaning, value] :
       {Share{"Interpolation",
              c.shares.quantisation
                  ? "light known at the vertices only"
                  : "light known at the vertices only, in colours fitted to what the file holds",
              c.shares.interpolation},
        Share{"Clipping", "colours above 1 cut off by the file", c.shares.clipping},
        Share{"Quantisation", "colours rounded to the steps of the file", c.shares.quantisation}}) {
    if (!value) continue;
    html += fmt::format(
        "<tr><th scope=\"row\">{}<small>{}</small></th><td><span class=\"share\"><i "
        "style=\"width:{:.2f}%\"></i></span>{}</td>"
        "</tr>\n",
        name, meaning, 100 * *value / largest, short_number(*value));
  }
  return html + "</tbody>\n</table>\n</section>\n";
}

/// What the methods would cost and leave, where one was chosen by itself.
std::string trials_section(const Comparison& c) {
  if (c.trials.empty()) return {};
  std::string html =
      std::string(
          "<section aria-labelledby=\"trials\">\n<h2 id=\"trials\">The methods that were tried</h2>\n") +
      (c.tolerance_space == ErrorSpace::linear
           ? "<p>Differences of linear values, as the tolerance is meant.</p>\n"
           : "") +
      "<table "
      "class=\"table "
      "stacked\">\n<thead><tr><th scope=\"col\">Method</th><th scope=\"col\" class=\"n\">Vertices</th><th "
      "scope=\"col\" "
      "class=\"n\">Bytes</th><th scope=\"col\" class=\"n\">Time</th><th scope=\"col\" "
      "class=\"n\">RMSE</th><th scope=\"col\" "
      "class=\"n\">Largest found</th><th scope=\"col\" class=\"n\">Certified</th></tr></thead>\n<tbody>\n";
  for (const MethodTrial& t : c.trials) {
    const auto cell = [&](const char* label, const std::string& value) {
      html += fmt::format("<td class=\"n\" data-label=\"{}\">{}</td>", label, value);
    };
    html += fmt::format("<tr><th scope=\"row\" data-label=\"Method\">{}</th>", name_of(t.method));
    cell("Vertices", grouped(t.n_vertices));
    cell("Bytes", grouped(t.bytes));
    cell("Time", duration(t.seconds));
    cell("RMSE", steps_of_255(t.rmse));
    cell("Largest found", steps_of_255(t.max_found));
    cell("Certified", bound_of_255(t.max_bound) + (t.is_certified ? "; within the tolerance" : ""));
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n</section>\n";
}

std::string worst_section(const Comparison& c) {
  const std::vector<SurfacePlace>& worst = c.surface_display.worst;
  if (worst.empty()) return {};
  const auto vector = [](const glm::dvec3& v) {
    // What rounding leaves beside a 1 is 0 to a reader.
    const auto number = [&](double x) { return short_number(std::abs(x) < 1e-9 * glm::length(v) ? 0 : x); };
    return fmt::format("{}, {}, {}", number(v.x), number(v.y), number(v.z));
  };
  std::string html =
      "<section aria-labelledby=\"worst\">\n<h2 id=\"worst\">The worst places on the surface</h2>\n"
      "<p class=\"soft\">Of all of it, also what no picture shows. Faces are counted from 0, barycentrics "
      "are of the "
      "first one's corners. <code>surface_error.ply</code> beside this page has each triangle in the colour "
      "of its "
      "worst place, on the scale of the map above.</p>\n"
      "<table class=\"table stacked\">\n<thead><tr><th scope=\"col\">Off by</th><th scope=\"col\">Face</th>"
      "<th scope=\"col\">Barycentrics</th><th scope=\"col\">Position</th><th scope=\"col\">Light that causes "
      "most of it"
      "</th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < worst.size(); ++i) {
    const SurfacePlace& place = worst[i];
    // The faces on both sides of an edge meet the same place.
    const auto is_here = [&](const SurfacePlace& other) {
      return glm::distance(other.position, place.position) <= 1e-6 * glm::length(place.position);
    };
    if (std::any_of(worst.begin(), worst.begin() + static_cast<std::ptrdiff_t>(i), is_here)) continue;
    std::string faces = grouped(place.source_face);
    for (std::size_t j = i + 1; j < worst.size(); ++j)
      if (is_here(worst[j])) faces += ", " + grouped(worst[j].source_face);
    html += fmt::format(
        "<tr><th scope=\"row\" data-label=\"Off by\">{}</th><td data-label=\"Face\">{}</td>"
        "<td data-label=\"Barycentrics\">{}</td><td data-label=\"Position\">{}</td><td "
        "data-label=\"Light\">{}</td></tr>\n",
        steps_of_255(place.error), faces, vector(place.barycentrics), vector(place.position),
        place.light && *place.light < c.light_names.size() ? escape_html(c.light_names[*place.light]) : "–");
  }
  return html + "</tbody>\n</table>\n</section>\n";
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
      "<section aria-labelledby=\"lights\">\n<h2 id=\"lights\">Each light's share</h2>\n"
      "<table class=\"table lights\">\n<thead><tr><th scope=\"col\">Light</th><th scope=\"col\">of the light "
      "on the "
      "surface</th><th scope=\"col\">of the error that interpolating makes</th></tr></thead>\n<tbody>\n";
  const auto row = [&](const std::string& name, const LightShare& share) {
    const auto cell = [](double value) {
      return fmt::format("<td><span class=\"share\"><i style=\"width:{:.2f}%\"></i></span>{}</td>",
                         100 * value, percent(value));
    };
    html +=
        fmt::format("<tr><th scope=\"row\">{}</th>{}{}</tr>\n", name, cell(share.light), cell(share.error));
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
  std::string html =
      "<section aria-labelledby=\"findings\">\n<h2 id=\"findings\">What was counted on reading</h2>\n";
  std::string items;
  for (const Finding& finding : c.findings)
    items += fmt::format("<li><b>{}</b> {}</li>\n", grouped(finding.count), escape_html(finding.text));
  if (c.seen_from_behind > 0)
    items += fmt::format("<li>{} the side of a face that its normal is not on</li>\n",
                         count_of(c.seen_from_behind, "pixel shows", "pixels show"));
  return html +
         (items.empty() ? "<p>Nothing: the file is sound.</p>\n"
                        : "<ul class=\"plain\">\n" + items + "</ul>\n") +
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
  const Differences differences = find_differences(c);
  return page_frame(c.input + " · lambake compare", header(c),
                    slider_section(c, differences.shown) + difference_section(c, differences) +
                        zooms_section(c, differences) + trials_section(c) + numbers_section(c) +
                        shares_section(c) + lights_section(c) + worst_section(c) + findings_section(c) +
                        made_section(c.command, c.version, times(c)));
}

}  // namespace lambake
