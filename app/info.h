// `talbot info SCENE`: what is in a scene file, as text or JSON, on stdout.
#pragma once

#include "app/options.h"

namespace talbot {

int run_info(const Options& options);

}  // namespace talbot
