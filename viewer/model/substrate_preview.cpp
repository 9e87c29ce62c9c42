#include "viewer/model/substrate_preview.h"

#include <fmt/format.h>

#include <algorithm>

#include "surface/base/error.h"
#include "surface/file/error_message.h"
#include "surface/maps/surface_part.h"
#include "viewer/model/palette_image.h"

namespace tangi {

namespace {

// When a file was written last; 0 for what is none.
long written(const std::string& file) {
    std::error_code none;
    const auto time = std::filesystem::last_write_time(file, none);
    return none ? 0 : static_cast<long>(time.time_since_epoch().count());
}

// All that the relief and colour depend on.
std::string base_of(const SubstrateChoice& c) {
    return fmt::format("{} {}\n{} {}\n{} {} {}", c.which, written(c.which), c.height_from,
                       written(c.height_from), c.piece.pixel_mm, c.piece.seed, c.picture.relief_mm);
}

// The middle of a surface.
Surface middle_of(const Surface& whole, int width, int height) {
    const int w = std::min(width, whole.width()), h = std::min(height, whole.height());
    const int x0 = (whole.width() - w) / 2, y0 = (whole.height() - h) / 2;
    return cut(whole, {x0, y0, x0 + w, y0 + h});
}

}  // namespace

SubstratePreview::~SubstratePreview() {
    stop_ = true;
    if (work_.valid()) work_.wait();
}

SubstratePreview::Base SubstratePreview::made(const SubstrateChoice& choice, const std::string& of) const {
    const Progress going_on = [this](std::string_view, double) { return !stop_; };
    SubstrateChoice plain = choice;
    plain.finish = {};
    plain.keep_as.clear();
    if (substrate_named(choice.which)) {
        plain.piece.width_mm = kWidth * choice.piece.pixel_mm;
        plain.piece.height_mm = kHeight * choice.piece.pixel_mm;
        return {of, make_substrate(plain, going_on), {}};
    }
    const Surface whole = make_substrate(plain, going_on);
    return {of, middle_of(whole, kWidth, kHeight), {whole.width(), whole.height()}};
}

SubstratePreview::Seen SubstratePreview::seen(const Wanted& wanted, std::shared_ptr<const Base>& base) const {
    Seen result;
    try {
        const std::string of = base_of(wanted.choice);
        if (!base || base->of != of) base = std::make_shared<Base>(made(wanted.choice, of));
        Surface piece = base->piece;
        apply(wanted.choice.finish, piece);
        const BoardPatch patch = board_patch(piece, piece.height_mm.region(), wanted.light);
        result.picture = Image<glm::u8vec4>(piece.width(), piece.height());
        for (std::size_t i = 0; i < patch.srgb.size(); ++i)
            result.picture.pixels()[i] = glm::u8vec4(patch.srgb[i], 255);
        result.size = base->size;
    } catch (const Cancelled&) {
        return result;
    } catch (const std::exception& error) {
        result.complaint = message_of(error);
    }
    return result;
}

void SubstratePreview::start() {
    under_way_ = wanted_;
    work_ = std::async(std::launch::async, [this] {
        Seen made = seen(under_way_, base_);
        wake_();
        return made;
    });
}

void SubstratePreview::want(const SubstrateChoice& choice, const Vec3& light) {
    const SubstrateFinish& f = choice.finish;
    std::string of =
        fmt::format("{}\n{} {} {} {} {}\n{} {} {}", base_of(choice), f.tint.r, f.tint.g, f.tint.b,
                    f.specular.value_or(-1), f.roughness.value_or(-1), light.x, light.y, light.z);
    if (of == wanted_.of) return;
    wanted_ = {choice, light, std::move(of)};
    if (!work_.valid()) start();
}

std::optional<SubstratePreview::Seen> SubstratePreview::fetch() {
    if (!work_.valid() || work_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return {};
    Seen made = work_.get();
    const bool is_old = under_way_.of != wanted_.of;
    if (is_old) start();
    return made;
}

}  // namespace tangi
