#include "firmware/program/torso_sensor_report.h"

#include <cstdio>
#include <utility>

namespace stilt::program {

TorsoSensorReport::TorsoSensorReport(const Options& options)
    : encoder_(configuration::robot_wiring(options.configuration.hardware).pitch_encoder) {}

void TorsoSensorReport::update(const ControllerState& state) {
  const torso_sensor::SerialTorsoSensor& serial = state.serial_torso_sensor;
  std::string now =
      encoder_ ? sentence(state.hardware->torso_sensor_trouble(), *encoder_) : serial.trouble_sentence();
  if (now == newest_) return;
  std::fprintf(stderr, "stiltd: %s\n", now.empty() ? "torso sensor: reports" : now.c_str());
  newest_ = std::move(now);
}

}  // namespace stilt::program
