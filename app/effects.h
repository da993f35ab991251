// `talbot effects SCENE`: the ledger of effects, with prices.
#pragma once

#include "app/options.h"

namespace talbot {

int run_effects(const Options& options);

}  // namespace talbot
