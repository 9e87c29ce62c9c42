// substrate_preview.h: what a new canvas will look like, made beside the window. No OpenGL.
#pragma once

#include <atomic>
#include <functional>
#include <future>
#include <glm/gtc/type_precision.hpp>
#include <memory>
#include <optional>
#include <string>

#include "paint/substrate/substrate_choice.h"
#include "viewer/render/view.h"

namespace tangi {

class SubstratePreview {
public:
    static constexpr int kWidth = 300, kHeight = 130;  // [pixels] at most, of the canvas

    // `wake`, from another thread, says that there is news.
    explicit SubstratePreview(std::function<void()> wake) : wake_(std::move(wake)) {}
    ~SubstratePreview();  // waits for the one that is being made

    // This one from now on, under a far light in this direction; what else was wanted is forgotten.
    void want(const SubstrateChoice& choice, const Vec3& light);
    void again() { wanted_.of.clear(); }  // what is wanted next is made, also where it is what was shown last

    struct Seen {
        Image<glm::u8vec4> picture;  // sRGB; empty where it cannot be made
        Extent size{};               // [pixels] of the whole canvas; of a procedure's piece 0
        std::string complaint;       // why it cannot be made
    };
    std::optional<Seen> fetch();  // what was made since the last call

private:
    struct Base {  // without finish and light
        std::string of;
        Surface piece;
        Extent size{};
    };
    struct Wanted {
        SubstrateChoice choice;
        Vec3 light{0};
        std::string of;
    };
    Base made(const SubstrateChoice& choice, const std::string& of) const;
    Seen seen(const Wanted& wanted, std::shared_ptr<const Base>& base) const;
    void start();

    std::function<void()> wake_;
    Wanted wanted_, under_way_;
    std::shared_ptr<const Base> base_;  // the work's, while it runs
    std::atomic<bool> stop_ = false;
    std::future<Seen> work_;
};

}  // namespace tangi
