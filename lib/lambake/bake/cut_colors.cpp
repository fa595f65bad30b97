#include "lambake/bake/cut_colors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "lambake/core/parallel.h"

namespace lambake {
namespace {

constexpr std::size_t block_size = 64;

}  // namespace

CutColors::CutColors(const Scene& scene, const BakeOptions& options, const CutMesh& cut)
    : scene_(scene),
      options_(options),
      cut_(cut),
      all_lights_(scene.lights.size()),
      materials_(vertex_materials(scene.mesh)) {
  std::iota(all_lights_.begin(), all_lights_.end(), 0U);
  if (options.output.shown) {
    const std::vector<bool> is_used = used_materials(scene.mesh, scene.materials.size());
    for (std::size_t m = 0; m < is_used.size(); ++m)
      if (is_used[m]) rounding_ = std::max(rounding_, largest_rounding(scene.materials[m]));
    if (rounding_ > 0.51 * options.tolerance) rounding_ = 0;
  }
  add_new_vertices();
}

double CutColors::largest_rounding(const Material& material) const {
  constexpr int n_greys = 1000;
  const LinearRgb brightest = stored_range(options_.output, material).high;
  double largest = 0;
  for (int i = 1; i < n_greys; ++i) {
    // None is clipped.
    const auto grey = [share = static_cast<float>(i) / n_greys](float most) {
      return most > 0 ? share * std::min(most, 1.0f) : most;
    };
    const LinearRgb color{grey(brightest.r), grey(brightest.g), grey(brightest.b)};
    largest = std::max(largest, loss(material, color, as_stored(options_.output, color, material)));
  }
  return largest;
}

void CutColors::add_new_vertices() {
  const std::size_t first = colors_.size(), n = cut_.mesh().n_vertices();
  for (std::size_t i = materials_.size(); i < n; ++i)
    materials_.push_back(materials_[cut_.cuts()[i - cut_.n_uncut_vertices()].a]);
  colors_.resize(n), exact_.resize(n), rises_.resize(n, glm::vec3(0)), falls_.resize(n, glm::vec3(0));
  if (options_.output.shown) stored_.resize(n), is_spoilt_.resize(n, false);
  parallel_blocks(n - first, block_size, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = first + begin; v < first + end; ++v) {
      Patch point;
      point.positions[0] = cut_.positions()[v];
      point.normals[0] = cut_.normals()[v];
      if (!cut_.albedos().empty()) point.albedos[0] = cut_.albedos()[v];
      const glm::vec3 c(
          reference_at(point, scene_.lights, all_lights_, material(v).is_unlit, glm::dvec3(1, 0, 0)));
      exact_[v] = {c.r, c.g, c.b};
      move(v);
    }
  });
}

Patch CutColors::patch(const glm::uvec3& t) const {
  Patch patch;
  for (int c = 0; c < 3; ++c) {
    patch.positions[c] = cut_.positions()[t[c]];
    patch.normals[c] = cut_.normals()[t[c]];
    if (!cut_.albedos().empty()) patch.albedos[c] = cut_.albedos()[t[c]];
    patch.colors[c] = {colors_[t[c]].r, colors_[t[c]].g, colors_[t[c]].b};
  }
  return patch;
}

void CutColors::ask(std::size_t v, const glm::vec3& shift) {
  rises_[v] = glm::max(rises_[v], shift), falls_[v] = glm::min(falls_[v], shift);
}

void CutColors::share_among_copies() {
  const std::vector<std::uint32_t>& places = cut_.places();
  std::vector<std::uint32_t> counts, copies;
  for (const std::uint32_t place : places) {
    if (place >= counts.size()) counts.resize(place + 1, 0);
    ++counts[place];
  }
  for (std::uint32_t v = 0; v < places.size(); ++v)
    if (counts[places[v]] > 1 && is_finite(exact_[v])) copies.push_back(v);
  const auto key = [&](std::uint32_t v) {
    return std::tie(places[v], exact_[v].r, exact_[v].g, exact_[v].b);
  };
  std::sort(copies.begin(), copies.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < copies.size();) {
    std::size_t end = i;
    glm::vec3 rise(0), fall(0);
    for (; end < copies.size() && key(copies[end]) == key(copies[i]); ++end)
      rise = glm::max(rise, rises_[copies[end]]), fall = glm::min(fall, falls_[copies[end]]);
    for (; i < end; ++i) rises_[copies[i]] = rise, falls_[copies[i]] = fall;
  }
}

std::vector<char> CutColors::move_back(const std::vector<char>& is_marked_place) {
  for (std::size_t v = 0; v < colors_.size(); ++v)
    if (is_marked_place[cut_.places()[v]]) rises_[v] = falls_[v] = glm::vec3(0);
  return move_all();
}

std::vector<char> CutColors::move_asked() {
  share_among_copies();
  return move_all();
}

std::vector<char> CutColors::move_all() {
  std::vector<char> is_moved(colors_.size(), 0);
  for (std::size_t v = 0; v < colors_.size(); ++v) {
    const LinearRgb before = colors_[v];
    move(v);
    is_moved[v] = colors_[v] != before;
  }
  return is_moved;
}

LinearRgb CutColors::moved(std::size_t v) const {
  const glm::vec3 shift = rises_[v] + falls_[v];
  return exact_[v] + LinearRgb{shift.r, shift.g, shift.b};
}

void CutColors::move(std::size_t v) {
  colors_[v] = moved(v);
  if (!options_.output.shown) return;
  const auto stored = [&](const LinearRgb& color) { return as_stored(options_.output, color, material(v)); };
  stored_[v] = stored(colors_[v]);
  // A shift that the output cuts short is only a smaller one.
  is_spoilt_[v] =
      spoils(material(v), colors_[v], stored_[v]) && spoils(material(v), exact_[v], stored(exact_[v]));
  if (!is_spoilt_[v]) colors_[v] = stored_[v];
}

double CutColors::loss(const Material& material, const LinearRgb& color, const LinearRgb& stored) const {
  const auto of_channel = [&](double was, double is, double base, double emission) {
    if (options_.tolerance_space == ErrorSpace::linear) return std::abs(was - is);
    // Behind a texture what is above 1 may still be seen.
    if (has_texture(material)) return std::abs(srgb_encode(base * was) - srgb_encode(base * is));
    return std::abs(compared(emission + base * was, ErrorSpace::display) -
                    compared(emission + base * is, ErrorSpace::display));
  };
  const LinearRgb &base = material.base_color, emission = emission_of(material);
  return std::max({of_channel(color.r, stored.r, base.r, emission.r),
                   of_channel(color.g, stored.g, base.g, emission.g),
                   of_channel(color.b, stored.b, base.b, emission.b)});
}

bool CutColors::spoils(const Material& material, const LinearRgb& color, const LinearRgb& stored) const {
  return loss(material, color, stored) > std::max(0.25 * options_.tolerance, 1.02 * rounding_);
}

void CutColors::take_stored() {
  if (options_.output.shown) colors_ = stored_;
}

std::vector<LinearRgb> CutColors::take_colors() {
  for (std::size_t v = 0; v < colors_.size(); ++v) colors_[v] = moved(v);
  return std::move(colors_);
}

}  // namespace lambake
