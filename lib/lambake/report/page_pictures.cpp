#include "lambake/report/page_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "lambake/io/image_file.h"
#include "lambake/report/charts.h"
#include "lambake/report/difference.h"
#include "lambake/report/page_frame.h"
#include "lambake/report/text.h"

namespace lambake {
namespace {

std::string data_uri(const Picture& picture) {
  return "data:image/png;base64," + base64(encode_png(picture));
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
{histogram}<figcaption>{over} of {pixels} pixels are off by more than 1/255, the smallest step of an ordinary screen. The scale upwards is logarithmic.</figcaption>
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
      section_begin("zooms", "The worst places of the picture, enlarged") + "<div class=\"columns\">\n";
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

}  // namespace

std::string picture_sections(const Comparison& c) {
  const Differences differences = find_differences(c);
  return slider_section(c, differences.shown) + difference_section(c, differences) +
         zooms_section(c, differences);
}

}  // namespace lambake
