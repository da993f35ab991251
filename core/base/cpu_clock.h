// Processor time, which other programs on the machine do not stretch as they do the time on the
// wall.
#pragma once

namespace talbot {

// Seconds that the calling thread, or all threads of the process, have run.
double thread_cpu_seconds();
double process_cpu_seconds();

}  // namespace talbot
