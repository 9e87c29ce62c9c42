// shortcuts_test.cpp: keys, their names, and the file in which the user changes them; what is
// remembered.
#include "viewer/model/shortcuts.h"

#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include <set>

#include "surface/file/atomic_file.h"
#include "tests/support/test_support.h"
#include "viewer/dialogs/file_dialog.h"
#include "viewer/model/user_settings.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;

TEST(Shortcuts, NamesAndKeysAreUnique) {
    const Keys keys;
    std::set<std::string> names;
    for (const Shortcut& shortcut : shortcuts()) {
        EXPECT_TRUE(names.insert(shortcut.name).second) << shortcut.name;
        EXPECT_FALSE(keys.text(shortcut.action).empty()) << shortcut.name << ": another action has its key";
    }
}

TEST(Shortcuts, ChordsAreReadAsTheyAreWritten) {
    for (const char* text : {"A", "7", "[", "Ctrl+Z", "Ctrl+Shift+S", "Alt+F4", "F12", "PageDown", "Comma"}) {
        const auto chord = chord_named(text);
        ASSERT_TRUE(chord) << text;
        EXPECT_EQ(name_of(*chord), text);
    }
    EXPECT_EQ(chord_named("ctrl+pageup"), (Chord{GLFW_KEY_PAGE_UP, GLFW_MOD_CONTROL}));
    for (const char* text : {"", "Hyper+A", "AB", "F26", "Ctrl+", "\xc3\xa4"})
        EXPECT_FALSE(chord_named(text)) << text;
}

TEST(Shortcuts, TheFileChangesThem) {
    TestDir folder;
    const fs::path file = folder / "keys.json";
    EXPECT_EQ(Keys::read(file).text(Action::shadows), "S") << "no file: the usual ones";
    write_text_file(file, R"({"shadows": "Shift+S", "redo": ["Ctrl+R", "F5"], "loupe": [], "compare": "D"})");
    const Keys keys = Keys::read(file);
    EXPECT_EQ(keys.action(GLFW_KEY_S, GLFW_MOD_SHIFT), Action::shadows);
    EXPECT_FALSE(keys.action(GLFW_KEY_S, 0));
    EXPECT_EQ(keys.text(Action::redo), "Ctrl+R, F5");
    EXPECT_EQ(keys.text(Action::loupe), "");
    EXPECT_EQ(keys.action(GLFW_KEY_D, 0), Action::compare);
    EXPECT_EQ(keys.text(Action::dry), "") << "lost its key to the user's";
    // Lock keys do not matter.
    EXPECT_EQ(keys.action(GLFW_KEY_T, GLFW_MOD_CAPS_LOCK), Action::tool_tilt);
}

TEST(Shortcuts, WhatIsChangedIsKept) {
    TestDir folder;
    const fs::path file = folder / "settings" / "keys.json";  // a folder that is not there yet
    Keys keys;
    EXPECT_FALSE(keys.set(Action::loupe, Chord{GLFW_KEY_F5, GLFW_MOD_CONTROL}));
    EXPECT_EQ(keys.set(Action::redo, chord_named("S")), Action::shadows) << "which had it";
    EXPECT_EQ(keys.text(Action::shadows), "");
    EXPECT_EQ(keys.text(Action::redo), "S");
    EXPECT_FALSE(keys.action(GLFW_KEY_Y, GLFW_MOD_CONTROL)) << "the only key is the new one";
    EXPECT_FALSE(keys.set(Action::dry, {}));
    keys.write(file);
    const Keys again = Keys::read(file);
    for (const Shortcut& shortcut : shortcuts())
        EXPECT_EQ(again.text(shortcut.action), keys.text(shortcut.action)) << shortcut.name;
    EXPECT_EQ(again.action(GLFW_KEY_F5, GLFW_MOD_CONTROL), Action::loupe);
    EXPECT_FALSE(again.action(GLFW_KEY_D, 0));
    Keys().write(file);
    EXPECT_EQ(Keys::read(file).text(Action::shadows), "S") << "the usual ones";
}

TEST(Shortcuts, AWrongFileIsNamed) {
    TestDir folder;
    const fs::path file = folder / "keys.json";
    for (const auto& [text, complaint] : std::vector<std::pair<const char*, const char*>>{
             {"[1]", "is not a JSON object"},
             {R"({"shadow": "S"})", "no action 'shadow'"},
             {R"({"shadows": 7})", "'shadows' must be a key"},
             {R"({"shadows": "Strg+S"})", "'Strg+S' is no key"},
             {R"({"shadows": "F5", "loupe": "F5"})", "two actions have the key F5"}}) {
        write_text_file(file, text);
        try {
            Keys::read(file);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr(complaint));
            EXPECT_THAT(error.what(), testing::HasSubstr("keys.json"));
        }
    }
}

TEST(Settings, RecentPaintingsAreThoseThatAreThere) {
    TestDir folder;
    const fs::path settings = folder / "settings";
    EXPECT_THAT(recent_paintings(settings), testing::IsEmpty());
    for (int i = 0; i < 12; ++i) {
        const fs::path painting = folder / fmt::format("{}.exr", i);
        write_text_file(painting, "x");
        remember_painting(settings, painting);
    }
    remember_painting(settings, folder / "3.exr");
    fs::remove(folder / "11.exr");
    std::vector<std::string> names;
    for (const fs::path& painting : recent_paintings(settings)) names.push_back(painting.filename().string());
    EXPECT_THAT(names, testing::ElementsAre("3.exr", "10.exr", "9.exr", "8.exr", "7.exr", "6.exr", "5.exr",
                                            "4.exr", "2.exr"));
    write_text_file(settings / "recent.json", "{nonsense");
    EXPECT_THAT(recent_paintings(settings), testing::IsEmpty());
}

TEST(FileDialog, UnderstandsWhatIsTyped) {
    using panels::FileDialog;
    using Wants = FileDialog::Wants;
    TestDir folder;
    fs::create_directory(folder / "photos");
    write_text_file(folder / "a.exr", "x");
    const auto choice = [&](Wants wants, const std::string& typed) {
        return FileDialog::choice(wants, ".exr", folder.path(), typed);
    };
    EXPECT_EQ(choice(Wants::file, "a.exr").path, folder / "a.exr");
    EXPECT_EQ(choice(Wants::file, (folder / "a.exr").string()).path, folder / "a.exr") << "a whole path";
    EXPECT_NE(choice(Wants::file, "b.exr").complaint, "");
    EXPECT_EQ(choice(Wants::folder, "").path, folder.path());
    EXPECT_EQ(choice(Wants::folder, "photos").path, folder / "photos");
    EXPECT_NE(choice(Wants::folder, "a.exr").complaint, "");
    EXPECT_EQ(choice(Wants::new_file, "b").path, folder / "b.exr");
    EXPECT_FALSE(choice(Wants::new_file, "b").exists);
    EXPECT_TRUE(choice(Wants::new_file, "a.exr").exists) << "to be asked about";
    EXPECT_NE(choice(Wants::new_file, "nowhere/b.exr").complaint, "");
    EXPECT_EQ(choice(Wants::new_file, "B.EXR").path, folder / "B.EXR");
    EXPECT_EQ(choice(Wants::new_file, "Madonna 1.5").path, folder / "Madonna 1.5.exr");
    EXPECT_EQ(choice(Wants::new_file, "b.").path, folder / "b.exr");
    EXPECT_THAT(choice(Wants::new_file, "b.pdf").complaint,
                testing::HasSubstr("written as .exr, not as .pdf"));
    EXPECT_THAT(choice(Wants::new_file, "b.PNG").complaint, testing::HasSubstr("not as .png"));
    const auto page = [&](const std::string& typed) {
        return FileDialog::choice(Wants::new_file, ".html .pdf", folder.path(), typed);
    };
    EXPECT_EQ(page("r").path, folder / "r.html");
    EXPECT_EQ(page("r.Html").path, folder / "r.Html");
    EXPECT_EQ(page("r.pdf").path, folder / "r.html") << "the page, with r.pdf beside it";
    EXPECT_EQ(page("r.PDF").path, folder / "r.html");
    EXPECT_THAT(page("r.exr").complaint, testing::HasSubstr("written as .html"));
    EXPECT_EQ(choice(Wants::new_folder, "").path, folder.path());
    EXPECT_EQ(choice(Wants::new_folder, "report").path, folder / "report") << "it is made";
    EXPECT_NE(choice(Wants::new_folder, "nowhere/report").complaint, "");
    EXPECT_NE(choice(Wants::new_folder, "a.exr").complaint, "");
    EXPECT_EQ(choice(Wants::folder_or_file, "a.exr").path, folder / "a.exr");
    EXPECT_EQ(choice(Wants::folder_or_file, "photos").path, folder / "photos");
    write_text_file(folder / "a.txt", "x");
    EXPECT_NE(choice(Wants::folder_or_file, "a.txt").complaint, "");
}

TEST(FileDialog, TakesNamesAsDesktopsDo) {
    using panels::FileDialog;
    using Wants = FileDialog::Wants;
    TestDir folder;
    fs::create_directories(folder / "here/sub");
    write_text_file(folder / "here/ led.exr", "x");
    const std::string home = std::getenv("HOME") ? std::getenv("HOME") : "";
    ::setenv("HOME", folder.path().c_str(), 1);
    const auto choice = [&](Wants wants, const std::string& typed) {
        return FileDialog::choice(wants, ".exr", folder / "here", typed);
    };
    EXPECT_EQ(choice(Wants::new_file, " lead.exr ").path, folder / "here/lead.exr");
    EXPECT_EQ(choice(Wants::new_file, "lead \t").path, folder / "here/lead.exr");
    EXPECT_EQ(choice(Wants::new_file, "sub/ x").path, folder / "here/sub/ x.exr") << "within it they count";
    EXPECT_EQ(choice(Wants::file, " led.exr").path, folder / "here/ led.exr") << "it is there";
    EXPECT_EQ(choice(Wants::new_file, " led.exr").path, folder / "here/ led.exr");
    EXPECT_EQ(choice(Wants::new_file, "~/h.exr").path, folder / "h.exr");
    EXPECT_EQ(choice(Wants::new_folder, "~/report").path, folder / "report");
    EXPECT_EQ(choice(Wants::new_file, "../up").path, folder / "up.exr");
    // Folders that one goes to.
    for (const auto& [typed, at] : {std::pair("..", folder.path()),
                                    {" .. ", folder.path()},
                                    {"../", folder.path()},
                                    {".", folder / "here"},
                                    {"sub/", folder / "here/sub"},
                                    {"~", folder.path()},
                                    {"~/", folder.path()}}) {
        const auto chosen = choice(Wants::new_file, typed);
        EXPECT_EQ(chosen.path, at / "") << typed;
        EXPECT_EQ(choice(Wants::folder, typed).path, at) << typed;
    }
    EXPECT_THAT(choice(Wants::new_file, "nowhere/").complaint, testing::HasSubstr("no such folder"));
    for (const char* none : {"...", ".exr", ".EXR", ".png", "sub/.exr"})
        EXPECT_THAT(choice(Wants::new_file, none).complaint, testing::HasSubstr("needs a name")) << none;
    EXPECT_EQ(choice(Wants::new_file, "   ").complaint, "type or click a name");
    for (const std::size_t length : {240, 255, 256, 5000})
        for (const Wants wants : {Wants::new_file, Wants::new_folder})
            EXPECT_THAT(choice(wants, std::string(length, 'n')).complaint,
                        testing::HasSubstr("the name is too long"))
                << length;
    ::setenv("HOME", home.c_str(), 1);
}

TEST(SettingsFile, KeepsWhatSomebodyElseMadeOfIt) {
    const TestDir dir;
    const auto path = dir / "keys.json";
    SettingsFile file(path);
    EXPECT_EQ(file.make_way(), "") << "there is none yet";
    write_bytes(path, "ours");
    file.is_written();
    EXPECT_EQ(file.make_way(), "");
    write_bytes(path, "theirs, by hand");
    EXPECT_EQ(file.make_way(),
              path.string() + " was changed by another program, and is kept as keys.other.json");
    EXPECT_EQ(bytes_of(dir / "keys.other.json"), "theirs, by hand");
    EXPECT_FALSE(std::filesystem::exists(path));
    write_bytes(path, "no JSON");
    SettingsFile bad(path);
    bad.cannot_be_read();
    EXPECT_EQ(bad.make_way(), path.string() + " could not be read, and is kept as keys.wrong.json");
    EXPECT_EQ(bytes_of(dir / "keys.wrong.json"), "no JSON");
}

}  // namespace
}  // namespace tangi
