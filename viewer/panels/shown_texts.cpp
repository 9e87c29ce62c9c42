#include "viewer/panels/shown_texts.h"

namespace tangi {

namespace {

using See = std::function<void(std::string_view)>;

template <class Texts>
void each_of(const Texts& texts, const See& see) {
    for (const std::string& text : texts) see(text);
}

void job_of(const std::optional<Job::State>& job, const See& see) {
    if (!job) return;
    see(job->stage);
    see(job->error);
}

void comparing_of(const Comparing& c, const See& see) {
    see(c.folder);
    see(c.news.stage);
    for (const auto& [index, why] : c.news.broken) see(why);
    if (c.pair) {
        see(c.pair->left);
        see(c.pair->right);
    }
    if (!c.news.book) return;
    for (const PhotoBook::Entry& entry : c.news.book->entries()) see(entry.name);
    each_of(c.news.book->warnings(), see);
}

void matches_of(const TreatmentState& t, const See& see) {
    if (t.match) {
        see(t.match->of);
        for (const ShownRecipe& recipe : t.match->recipes) {
            see(recipe.text);
            see(recipe.gloss);
            each_of(recipe.warnings, see);
        }
    }
    for (const PigmentPair& pair : t.pairs) {
        each_of(pair.first, see);
        each_of(pair.second, see);
        see(pair.why);
        see(pair.source);
    }
    for (const std::string* text : {&t.new_pair.first, &t.new_pair.second, &t.new_pair.why}) see(*text);
}

void treatment_state_of(const TreatmentState& t, const See& see) {
    for (const std::string* text : {&t.folder, &t.who, &t.usual_who, &t.no_strokes, &t.job_title}) see(*text);
    each_of(t.faults, see);
    for (const LogRow& row : t.log) {
        see(row.who);
        see(row.action);
    }
    for (const LayerRow& layer : t.layers) see(layer.name);
    if (t.suggestion) see(t.suggestion->measured);
    if (t.preview) {
        see(t.preview->lines);
        each_of(t.preview->piles, see);
    }
    matches_of(t, see);
    job_of(t.job, see);
}

void annotations_of(const AnnotationState& a, const See& see) {
    for (const auto& annotation : a.items) see(annotation->text);
    see(a.file);
}

void painting_of(const WindowState& s, const See& see) {
    see(s.palette.name);
    for (const Pigment& paint : s.palette.paints) see(paint.name);
    for (const auto& [name, brush] : s.brushes) see(name);
    each_of(s.painter.layers, see);
    if (s.probe)
        for (const auto& [name, part] : s.probe->recipe) see(name);
    const NewCanvas& n = s.new_canvas;
    for (const std::string* text :
         {&n.choice.which, &n.choice.keep_as, &n.choice.height_from, &n.picture, &n.name, &n.complaint})
        see(*text);
    each_of(n.kept, see);
    see(n.folder.string());
}

}  // namespace

void each_shown_text(const WindowState& s, const See& see) {
    for (const std::string* text : {&s.title, &s.message, &s.job_title, &s.monitor, &s.follow.gamepad})
        see(*text);
    each_of(s.doubts, see);
    each_of(s.said, see);
    each_of(s.pens, see);
    for (const std::filesystem::path& painting : s.recent) see(painting.string());
    see(s.dropped.string());
    see(s.open_next.string());
    job_of(s.job, see);
    painting_of(s, see);
    comparing_of(s.comparing, see);
    treatment_state_of(s.treatment_state, see);
    annotations_of(s.annotations, see);
}

}  // namespace tangi
