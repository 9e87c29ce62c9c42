// light_outlier_vote.h: whether a light that was found odd (light_outliers.h) explains its photograph better
// than the listed one does, pixel by pixel, gloss and all.
//
// What light_outliers.h goes by is matt: where part of a painting shines (gold leaf, and the more where it
// was brushed), a photograph can seem to be lit from elsewhere that is not. The pixels of a sample, fitted to
// all other photographs, have to predict it better under the light that it seems to show.
#pragma once

#include "fit/calibration/light_sample.h"
#include "fit/light_checks/light_outliers.h"

namespace tangi {

// Takes out those for which not more than half of the pixels vote. `listed` has the lights as they are
// listed, `lighting` as they were found to be, both in the order of the sample's stack; strengths are found
// again for either light. Those whose photograph hardly any pixel shows stay.
void take_vote(LightOutliers& outliers, const LightSample& sample, const std::vector<Light>& listed,
               const Lighting& lighting, const ReflectanceModel& reflectance_model);

}  // namespace tangi
