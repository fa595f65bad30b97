#include <cmath>
#include <nlohmann/json.hpp>

#include "lambake/report/json_parts.h"
#include "lambake/report/report.h"

namespace lambake {
namespace {

using Json = nlohmann::ordered_json;

Json image_json(const ImageError& e) {
  const auto of_pixels = [&](double value) { return e.pixels > 0 ? value : NAN; };
  return {{"rmse", of_pixels(e.rmse)},
          {"mae", of_pixels(e.mae)},
          {"mean", of_pixels(e.mean)},
          {"max", of_pixels(e.max)},
          {"max_pixel", {e.max_x, e.max_y}},
          {"max_view", e.max_view},
          {"psnr_db", of_pixels(e.psnr_db)},
          {"p99", of_pixels(e.p99)},
          {"pixels", e.pixels},
          {"pixels_over_1_255", e.pixels_over_1_255},
          {"nonfinite_samples", e.nonfinite}};
}

Json surface_json(const SurfaceError& e, const std::optional<double>& max_bound) {
  Json json = {{"rmse", e.rmse}, {"mae", e.mae}, {"mean", e.mean}, {"max_sampled", e.max_sampled}};
  if (max_bound) json["max_bound"] = *max_bound;
  json["area"] = e.area;
  return json;
}

Json place_json(const SurfacePlace& place) {
  const auto vector = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
  return {{"face", place.source_face},
          {"triangle", place.triangle},
          {"barycentrics", vector(place.barycentrics)},
          {"position", vector(place.position)},
          {"error", place.error},
          {"light", place.light ? Json(*place.light) : Json(nullptr)}};
}

}  // namespace

std::string report_json(const Comparison& c) {
  Json json;
  json["input"] = c.input;
  json["command"] = c.command;
  json["version"] = c.version;
  json["method"] = c.method;
  json["normals"] = c.normals;
  if (!c.verdict.empty()) json["verdict"] = c.verdict;
  if (!c.trials.empty()) {
    json["tolerance_space"] = c.tolerance_space == ErrorSpace::linear ? "linear" : "display";
    json["trials"] = trials_json(c.trials);
  }
  json["vertices"] = c.n_vertices;
  json["triangles"] = c.n_triangles;
  json["scene_vertices"] = c.n_scene_vertices;
  json["scene_triangles"] = c.n_scene_triangles;
  json["lights"] = c.n_lights;
  json["light_names"] = c.light_names;
  if (!c.light_shares.empty()) {
    json["light_shares"] = Json::array();
    for (const LightShare& share : c.light_shares)
      json["light_shares"].push_back({{"light", share.light}, {"error", share.error}});
  }
  json["views"] = c.n_views;
  json["image"] = {{"linear", image_json(c.image_linear)}, {"display", image_json(c.image_display)}};
  json["image"]["display"]["histogram"] = c.image_display.histogram;
  json["surface"] = {{"linear", surface_json(c.surface_linear, c.max_bound_linear)},
                     {"display", surface_json(c.surface_display, c.max_bound_display)}};
  json["heat_map_scale"] = heat_map_scale(c.per_vertex, c.per_fragment, c.visibility);
  json["error_shares"] = {{"interpolation", c.shares.interpolation},
                          {"clipping", c.shares.clipping},
                          {"quantisation", c.shares.quantisation}};
  const std::vector<SurfacePlace>& worst = c.surface_display.worst;
  json["max_at"] = worst.empty() ? Json(nullptr) : place_json(worst.front());
  json["worst"] = Json::array();
  for (const SurfacePlace& place : worst) json["worst"].push_back(place_json(place));
  json["clipped_vertices"] = c.clipped_vertices;
  json["pixels_seen_from_behind"] = c.seen_from_behind;
  json["findings"] = findings_json(c.findings);
  json["seconds"] = seconds_json(c.seconds);
  return json_text(json) + '\n';
}

}  // namespace lambake
