// bristle_loads.h: how much of each paint is on each bristle of a brush, and how that lies over the pixels of
// the canvas.
//
// Each cell of the brush, a square of a pixel's size that turns with it, owns its paint. Steps of a stroke
// work on a view: the cells as the canvas's pixels see them, bilinear, each cell shared out completely. When
// the brush turns, or rests, what pixels of the view have lost since is taken from the cells that they saw,
// in the same proportion, and what they have gained goes to these cells. So volume is conserved, and since no
// view is made of another one, paint stays on its bristle however often the brush turns.
#pragma once

#include <vector>

#include "paint/canvas/paint_layer.h"

namespace tangi {

class BristleLoads {
public:
    // Cells |u| <= half_u along the brush's width and |v| <= half_v along its thickness; pixels |x|, |y| <=
    // half of the view. Paint belongs at least three cells within the border.
    BristleLoads(int half_u, int half_v, int half);

    int half_u() const { return half_u_; }
    int half_v() const { return half_v_; }
    const std::vector<IngredientId>& ingredients() const { return ids_; }  // ascending

    void clear();
    // Cells [mm], rows of 2 half_u + 1, of each ingredient; as they would be after rest().
    std::vector<std::vector<float>> cells() const;
    // Takes these, one for each of `ingredients`, which ascend.
    void set(std::vector<IngredientId> ingredients, std::vector<std::vector<float>> cells);

    // Makes the view of the brush with its width at this angle from the x axis, towards y.
    void turn_to(float rotation_rad);
    // Ends the view. What follows depends on the cells only.
    void rest();

    // The view [mm], rows of 2 half + 1, as last turned; a plane is made where there is none.
    float* view(IngredientId ingredient);
    float* view_total();

private:
    struct Row;
    template <class Body>
    void for_rows(const Body& body) const;
    void balance();
    void look();
    void settle(std::vector<std::vector<float>>& cells) const;
    std::size_t number_of(IngredientId ingredient);

    int half_u_, half_v_, half_;
    float rotation_rad_ = 0;
    bool viewed_ = false;
    std::vector<IngredientId> ids_;
    std::vector<std::vector<float>> cells_, views_;
    std::vector<float> total_;   // of the view
    std::vector<float> seen_;    // [1] of each cell: what makes all of it seen
    std::vector<float> even_;    // [1] of each pixel: what makes it see as much as others
    std::vector<float> scaled_;  // of one ingredient: cells over seen_
};

}  // namespace tangi
