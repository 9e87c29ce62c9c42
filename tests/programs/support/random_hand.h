// random_hand.h: a hand that does anything at all in a window: keys, drags, wheel, resizing. Seeded.
#pragma once

#include <iterator>
#include <sstream>

#include "tests/programs/support/window_screen.h"

namespace tangi {

class RandomHand {
public:
    // `named`: paths that it may type into a dialog; `further`: keys that it presses, beside the usual ones.
    RandomHand(const Screen& screen, std::uint64_t seed, std::vector<std::string> named,
               const std::string& further)
        : screen_(screen),
          random_(seed),
          named_(std::move(named)),
          // All that has a meaning, and some that has none; not those that close the window.
          keys_(words_of(
              "t l h b i m g f 1 r comma period s o d c v ctrl+z ctrl+y ctrl+s ctrl+shift+s ctrl+o ctrl+r F1 "
              "F12 Tab Next Prior Left Right Up Down bracketleft bracketright Escape Return space a x F5 "
              "ctrl+a ctrl+n BackSpace Home shift+a F2 shift+F2 Delete ctrl+Next ctrl+Prior shift+x ctrl+l " +
              further)) {}

    // Some tens of actions; returns them as xdotool's words, to be repeated.
    std::string act() {
        std::vector<std::string> words;
        for (int i = 0; i < 30; ++i) add_action(words);
        words.insert(words.end(), {"mouseup", "1", "mouseup", "2", "mouseup", "3"});
        screen_.x_if_it_can(words);
        std::string done;
        for (const std::string& word : words) done += word + ' ';
        return done;
    }

private:
    static std::vector<std::string> words_of(const std::string& text) {
        std::istringstream stream(text);
        return {std::istream_iterator<std::string>(stream), {}};
    }

    void to_anywhere(std::vector<std::string>& words) {
        // The panels' column as often as the painting.
        const int x = random_.below(2) ? random_.below(300) : random_.below(Screen::kWidth);
        words.insert(words.end(),
                     {"mousemove", std::to_string(x), std::to_string(random_.below(Screen::kHeight))});
    }

    std::string any_key() {
        return keys_[static_cast<std::size_t>(random_.below(static_cast<int>(keys_.size())))];
    }

    // A stroke, with a key in its midst as often as not, and saved as often as not.
    void add_stroke(std::vector<std::string>& words) {
        const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
        const auto on_painting = [&] {
            add({"mousemove", std::to_string(kMiddleX - 150 + random_.below(300)),
                 std::to_string(kMiddleY - 100 + random_.below(200)), "sleep", "0.02"});
        };
        add({"key", "Escape", "key", "b"});
        on_painting();
        add({"mousedown", "1"});
        for (int i = random_.below(4); i >= 0; --i) on_painting();
        if (random_.below(2)) add({"key", any_key()});
        for (int i = random_.below(4); i >= 0; --i) on_painting();
        add({"mouseup", "1"});
        if (random_.below(2)) add({"key", "ctrl+s"});
    }

    void add_action(std::vector<std::string>& words) {
        const auto add = [&](std::initializer_list<std::string> more) { words.insert(words.end(), more); };
        switch (random_.below(13)) {
            case 0:
            case 1:
                add({"key", any_key()});
                break;
            case 2:
                to_anywhere(words);
                add({"click", std::to_string(4 + random_.below(2))});
                break;
            case 3:
            case 4:
                to_anywhere(words);
                add({"click", std::to_string(1 + random_.below(3))});
                break;
            case 5:
                if (random_.below(6)) break;
                add({"search", "--name", "TangiPaint", "windowsize", std::to_string(1 + random_.below(1400)),
                     std::to_string(1 + random_.below(900))});
                break;
            case 6:
                if (random_.below(4)) break;
                add({"type", "--delay", "5",
                     named_[static_cast<std::size_t>(random_.below(static_cast<int>(named_.size())))]});
                if (random_.below(2)) add({"key", "Return"});
                break;
            case 12:
                add_stroke(words);
                break;
            case 7:
                add({"mouseup", std::to_string(1 + random_.below(3))});
                break;
            default: {
                const std::string button = std::to_string(random_.below(4) ? 1 : 1 + random_.below(3));
                static const std::vector<std::string> held = {"", "", "", "shift", "alt"};
                const std::string mod = held[static_cast<std::size_t>(random_.below(5))];
                to_anywhere(words);
                if (!mod.empty()) add({"keydown", mod});
                add({"mousedown", button});
                for (int i = random_.below(6); i >= 0; --i) {
                    to_anywhere(words);
                    if (random_.below(2)) add({"sleep", "0.02"});
                }
                if (random_.below(8)) add({"mouseup", button});
                if (!mod.empty()) add({"keyup", mod});
                break;
            }
        }
    }

    const Screen& screen_;
    Random random_;
    std::vector<std::string> named_, keys_;
};

}  // namespace tangi
