// report_content.h: what a treatment's report is made of; for sources of this module only.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "retouch/report/report_document.h"
#include "retouch/treatment/treatment.h"

namespace tangi {

// What the report is of, read once.
struct ReportMatter {
    const Treatment& t;
    const Canvas& canvas;
    std::vector<TreatmentLayer> layers;
    Mask belongs;  // where paint may lie: on mapped damage
    ReportDocument report;

    template <class Block>
    void add(Block block) {
        report.blocks.emplace_back(std::move(block));
    }
    const std::vector<LogEntry>& log() const { return t.log().entries(); }
};

// As a page wants it that shows `side_by_side` of them.
Image<Rgb> fitting(const Image<Rgb>& picture, int side_by_side);

// "a_b" -> "a b"
std::string spaced(std::string name);

// "D65 1.2, A 0.9" of differences by illuminant.
std::string by_each_light(const nlohmann::json& differences);

// Each paint of a layer with its part of the volume, most first, and the volume where there is a scale.
std::string paints_in_words(const std::map<std::string, double>& volumes_mm3, bool scale_known);

// The last time that retouches were compared with what is beside them.
void add_quality(ReportMatter& matter);

}  // namespace tangi
