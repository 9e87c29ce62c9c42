// web_export_test.cpp: what of `export --to web` is typed: the sites that a page hears, the states that it
// shows, the folder that it goes to.
#include "cli/command.h"
#include "cli/export/web_origin.h"
#include "surface/base/json_text.h"
#include "surface/publish/selector_check.h"
#include "tests/programs/support/cli_program.h"

namespace tangi {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(WebOrigins, BecomeWhatBrowsersSend) {
    const auto sent = [](const std::string& words, const std::string& origin) {
        EXPECT_EQ(origin_as_sent(words), origin) << words;
        EXPECT_EQ(origin_as_sent(origin), origin) << "is sent so";
    };
    sent("https://museum.example", "https://museum.example");
    sent("HTTPS://Museum.Example", "https://museum.example");
    sent(" https://museum.example/\n", "https://museum.example");
    sent("https://museum.example:443", "https://museum.example");
    sent("http://museum.example:80", "http://museum.example");
    sent("http://museum.example:443", "http://museum.example:443");
    sent("https://museum.example:0443", "https://museum.example");
    sent("https://museum.example:8443", "https://museum.example:8443");
    sent("https://xn--Mnchen-3ya.example", "https://xn--mnchen-3ya.example");
    sent("http://localhost:8000", "http://localhost:8000");
    sent("http://[2001:DB8:0:0::1]:80", "http://[2001:db8::1]");
    sent("http://192.0.2.1:8000", "http://192.0.2.1:8000");
    sent("*", "*");
}

TEST(WebOrigins, ThatNoBrowserSendsSayWhatToWrite) {
    const auto refused = [](const std::string& words, const std::string& said) {
        try {
            ADD_FAILURE() << words << " became " << origin_as_sent(words);
        } catch (const UsageError& error) {
            EXPECT_THAT(error.what(), HasSubstr("--embed-origin " + words + ": "));
            EXPECT_THAT(error.what(), HasSubstr(said));
        }
    };
    refused("Museum.example", "write https://museum.example");
    refused("ftp://museum.example", "no scheme of web pages");
    refused("https://museum.example/room/", "write https://museum.example");
    refused("https://Museum.example:443?a=b", "write https://museum.example");
    refused("https://münchen.example", "punycode");
    refused("https://museum example", "' ' is in no name");
    refused("https://*.museum.example", "'*' is in no name");
    refused("https://me@museum.example", "leave it out");
    refused("https://", "is no name of a site");
    refused("https://museum..example", "is no name of a site");
    refused("https://museum.example:https", ":https is no port");
    refused("https://museum.example:65536", "65536 is no port");
    refused("https://192.0.2.300", "no IPv4 address");
    refused("https://[2001:db8]", "no IPv6 address");
}

TEST(CliWebExport, OriginsAreCheckedAndWrittenAsBrowsersSendThem) {
    const TinyStack stack;
    const auto exported = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"export", stack.truth(), "--to", "web", "--out", stack.out("page.html")});
        return tangipaint(more);
    };
    EXPECT_TRUE(ended(exported({"--embed-origin", "museum.example"}), 2, {"write https://museum.example"}));
    EXPECT_FALSE(fs::exists(stack.out("page.html")));
    ASSERT_TRUE(ended(exported({"--embed-origin", "HTTPS://Museum.Example:443/", "--embed-origin",
                                "https://museum.example"}),
                      0));
    EXPECT_THAT(read_text_file(stack.out("page.html")), HasSubstr(R"("origins":["https://museum.example"])"));
}

TEST(Selectors, SayWhichNumbersAreMissing) {
    const auto svg = [](const std::string& shape) { return why_no_svg("<svg>" + shape + "</svg>"); };
    for (const char* sound :
         {"<polygon points='1,2 3,4 5,6'/>", "<polygon points=\"1 2-3 4,5,.6\" class='a'/>",
          "<polyline points='1,2 3,4e2'/>", "<line x1='1' y2='+2'/>", "<rect width='3px' height='4'/>",
          "<circle class='point' cx='1' cy='2' r='0'/>", "<path d='M1,2 L3,4Z'/>", "<path d='m1 2h3'/>",
          "<text x='1' y='2'>a > b</text>", "<g><!-- a - > b --><ellipse rx='1' ry='2'/></g>"})
        EXPECT_EQ(svg(sound), "") << sound;
    EXPECT_EQ(svg("<polygon points='1,2 3,4'/>"),
              "SvgSelector has a polygon with 2 points, and takes 3 or more");
    EXPECT_THAT(svg("<polygon/>"), HasSubstr("0 points"));
    EXPECT_THAT(svg("<polygon points='1,2 3,b 5,6'/>"), HasSubstr("'b 5,6' in point 2, which is no number"));
    EXPECT_THAT(svg("<polygon points='1,2 3,nan 5,6'/>"), HasSubstr("which is no number"));
    EXPECT_THAT(svg("<polygon points='1,2 3,4 5'/>"), HasSubstr("an x without its y in point 3"));
    EXPECT_THAT(svg("<polyline points='1,2'/>"), HasSubstr("1 point, and takes 2"));
    EXPECT_THAT(svg("<rect x='1' y='2'/>"), HasSubstr("a rect with no width"));
    EXPECT_THAT(svg("<rect width='50%' height='2'/>"), HasSubstr("no number of pixels"));
    EXPECT_THAT(svg("<circle cx='1' r='-2'/>"), HasSubstr("below 0"));
    EXPECT_THAT(svg("<path d='L1,2'/>"), HasSubstr("begins with M"));
    EXPECT_THAT(svg("<path d='M1,2'/>"), HasSubstr("fewer than two points"));
    EXPECT_THAT(svg("<path d='M1,2 L x'/>"), HasSubstr("no number"));
    EXPECT_THAT(svg("<g/>"), HasSubstr("no shape: circle"));
    EXPECT_THAT(svg("<polygon points='1,2 3,4 5,6'>"), HasSubstr("closes </svg>"));
    EXPECT_THAT(why_no_svg("<svg><polygon points='1"), HasSubstr("ends within"));
    EXPECT_THAT(why_no_svg("<svg><!-- "), HasSubstr("ends within"));
    EXPECT_THAT(why_no_svg("polygon"), HasSubstr("no SVG at all"));
    for (const char* sound : {"xywh=1,2,3,4", "xywh=pixel:1,2,3,4", "xywh=percent:0,0,50.5,50"})
        EXPECT_EQ(why_no_fragment(sound), "") << sound;
    for (const char* wrong : {"xywh=1,2,3", "xywh=1,2,3,4,5", "xywh=1,2,3,x", "xywh=", "t=1,2,3,4", ""})
        EXPECT_THAT(why_no_fragment(wrong), HasSubstr("xywh=x,y,width,height")) << wrong;
    EXPECT_THAT(why_no_fragment("xywh=1,2,0,4"), HasSubstr("width or height"));
}

// Of every way that a file may name a place, in every format that takes annotations along.
TEST(CliWebExport, AnnotationsThatSelectNothingOrShareAnIdAreRefused) {
    const TinyStack stack;
    const auto note = [](const std::string& id, const nlohmann::json& target) {
        return nlohmann::json{{"type", "Annotation"}, {"id", id}, {"target", target}};
    };
    const auto exported = [&](const nlohmann::json& items, const std::string& to) {
        write_bytes(stack.out("notes.json"), json_line({{"type", "AnnotationPage"}, {"items", items}}));
        return tangipaint({"export", stack.truth(), "--to", to, "--out", stack.out(to), "--annotations",
                           stack.out("notes.json")});
    };
    const nlohmann::json sound = note("a", "p.jpg#xywh=1,2,3,4"),
                         svg = {{"selector",
                                 {{"type", "SvgSelector"}, {"value", "<svg><polygon points='1,2'/></svg>"}}}};
    for (const std::string to : {"web", "iiif", "openlime"}) {
        EXPECT_TRUE(ended(exported({sound, note("b", "p.jpg#xywh=1,2")}, to), 1,
                          {"notes.json: item 2 (\"b\"): its FragmentSelector", "remove the item"}));
        EXPECT_TRUE(ended(exported(nlohmann::json::array({note("c", svg)}), to), 1,
                          {"item 1 (\"c\")", "polygon with 1 point"}));
        EXPECT_TRUE(ended(exported({sound, note("b", "p.jpg#xywh=1,2,3,4"), sound}, to), 1,
                          {"item 3 (\"a\"): has the id of item 1"}));
        EXPECT_FALSE(fs::exists(stack.out(to)));
        EXPECT_TRUE(ended(exported(nlohmann::json::array({sound}), to), 0));
    }
}

TEST(CliWebExport, StatesHaveNamesOfTheirOwn) {
    const TinyStack stack;
    fs::create_directory(stack.out("earlier"));
    fs::copy(stack.truth(), stack.out("earlier"));
    const std::string same = stack.out("earlier/truth.exr");
    const auto exported = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"export", stack.truth(), "--to", "web", "--out", stack.out("page.html")});
        return tangipaint(more);
    };
    EXPECT_TRUE(
        ended(exported({"--state", "A=" + same, "--state", "A=" + same}), 2, {"two states are called A"}));
    EXPECT_TRUE(
        ended(exported({"--state", same}), 2, {"two states are called truth", "--state NAME=PAINTING.exr"}));
    EXPECT_FALSE(fs::exists(stack.out("page.html")));
    const Finished done = exported({"--state", "A=" + same, "--state", "B=" + same});
    ASSERT_TRUE(ended(done, 0));
    EXPECT_EQ(done.json()["states"], nlohmann::json({"A", "B", "truth"}));
}

}  // namespace
}  // namespace tangi
