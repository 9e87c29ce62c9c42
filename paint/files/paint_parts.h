// paint_parts.h: layers of paint as parts of a painting file: a channel `volume.NNNNN` [mm^3/mm^2 = mm] for
// each ingredient that occurs, NNNNN its number among the canvas's ingredients, and `volume_upper.NNNNN` for
// what of it is in the upper film (paint_layer.h).
//
// What is read throws Error naming the file, the part and the place.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "paint/canvas/canvas.h"
#include "surface/base/progress.h"
#include "surface/painting_file/painting_parts.h"

namespace tangi {

std::string volume_channel(IngredientId id);

// `layer` must outlive what is written.
PartToWrite part_of(const std::string& name, const PaintLayer& layer);
// What gives the rows of a part to `take`, as read_painting_part() does.
using TakeRows = std::function<void(int y0, int y1, std::span<const float* const> planes)>;
using PartReader = std::function<void(const PartInfo& info, const TakeRows& take)>;
PaintLayer layer_of(const std::filesystem::path& path, const PartInfo& info, const Canvas& canvas,
                    const PartReader& read);
PaintLayer read_layer(const std::filesystem::path& path, const PartInfo& info, const Canvas& canvas,
                      const Progress& progress = {});

// All of a canvas's ingredients, in the order of their numbers, in the attribute `ingredients`: a JSON list
// of name, k, s (12 bands, 1/mm), specular, roughness, origin, source.
void add_ingredients(PartInfo& info, const std::vector<Pigment>& ingredients);
void read_ingredients(const std::filesystem::path& path, const PartInfo& info, Canvas& canvas);

// The ingredients that a part's channels are of, of which `known` are there; `upper`: of an upper film, too.
std::vector<IngredientId> ingredients_of(const std::filesystem::path& path, const PartInfo& info,
                                         std::size_t known, bool upper);
// Volumes are finite and not negative (to rounding).
void require_volumes(const std::filesystem::path& path, const PartInfo& info, std::size_t channel, int y,
                     std::span<const float> row);

// More than there can be on one pixel, all ingredients together. There is no law that bounds it: sixty
// strokes of the thickest brush that settings allow, over each other, heap up 14 m. On bristles there may be
// all that was on a brush of another size.
constexpr float kMostPaint_mm = 1e9f, kMostOnBristles_mm = 1e12f;
// What row y holds of each ingredient, summed.
void require_thickness(const std::filesystem::path& path, const PartInfo& info, int y,
                       std::span<const float> sums, float most_mm);

}  // namespace tangi
