// Walks the simulated robot in a loop of its own: docs/library.md.
#include <stilt/controller.h>
#include <stilt/simulated_robot.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

/// The value, or the end of the program with the sentence that says what is wrong.
template <class Made>
auto made(Made result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "walk: %s\n", result.error().c_str());
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  const double speed_m_s = argc > 1 ? std::atof(argv[1]) : 0.5;
  const stilt::Settings settings{.robot = "amber3m"};
  stilt::Controller controller = made(stilt::Controller::create(settings));
  stilt::SimulatedRobot robot = made(stilt::SimulatedRobot::create(settings));

  const std::int64_t tick_ns = controller.tick_period_ns();
  const std::int64_t ticks_per_plan = controller.plan_period_ns() / tick_ns;
  controller.begin_standing(tick_ns, robot.read());

  double start_x_m = 0.0;
  for (std::int64_t tick = 0; robot.time_s() < 12.0 && !robot.fallen(); ++tick) {
    if (tick == 1000) controller.request(stilt::Motion::walk, speed_m_s);  // after a second
    if (tick == 4000) start_x_m = robot.hip_x_m();                         // at speed by now

    const stilt::Tick& done = controller.tick((tick + 1) * tick_ns, robot.read());
    if (tick % ticks_per_plan == 0) controller.plan();  // on a robot: on a thread of its own
    robot.drive(done);
    robot.advance();
    if (tick % 1000 == 0) std::printf("%5.1f s  %-5s  x %6.3f m  %s\n", done.time_s, done.state, robot.hip_x_m(), done.fault);
  }
  if (robot.fallen()) {
    std::printf("fell at %.2f s\n", robot.time_s());
    return 1;
  }
  std::printf("walked at %.3f m/s\n", (robot.hip_x_m() - start_x_m) / 8.0);
  return 0;
}
