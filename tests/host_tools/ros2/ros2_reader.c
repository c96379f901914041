/* An independent reader of the topics of stiltd, as a node of ROS 2 with rmw_cyclonedds would be one: the types are those
 * of the ROS 2 package, compiled by idlc (ros2_idl.py), the names those of ROS 2 on DDS.
 *
 *   ros2_reader DOMAIN    prints every sample and every publication as a JSON object on a line; ends with SIGTERM
 */
#include <dds/dds.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stilt_msgs/msg/Configuration.h"
#include "stilt_msgs/msg/Event.h"
#include "stilt_msgs/msg/Plan.h"
#include "stilt_msgs/msg/PlannerCycle.h"
#include "stilt_msgs/msg/Simulation.h"
#include "stilt_msgs/msg/Supervisor.h"
#include "stilt_msgs/msg/TickBatch.h"
#include "stilt_msgs/msg/Timing.h"
#include "stilt_msgs/msg/Tuning.h"

static volatile sig_atomic_t ends;

static void on_signal(int number) {
  (void)number;
  ends = 1;
}

static void number(double value) {
  if (isnan(value)) {
    printf("NaN");
  } else {
    printf("%.17g", value);
  }
}

static void text(const char* value) {
  putchar('"');
  for (; *value != '\0'; ++value) {
    const unsigned char letter = (unsigned char)*value;
    if (letter == '"' || letter == '\\' || letter < 0x20) {
      printf("\\u%04x", letter);
    } else {
      putchar(letter);
    }
  }
  putchar('"');
}

#define NAME(field) printf(", \"%s\": ", #field)
#define VALUE(field, use) \
  do {                    \
    NAME(field);          \
    use;                  \
  } while (0)
#define NUMBER(field) VALUE(field, number((double)sample->field))
#define BIG(field) VALUE(field, printf("%" PRIu64, (uint64_t)sample->field))
#define TEXT(field) VALUE(field, text(sample->field))
#define LIST(field, length, use)                                 \
  do {                                                           \
    NAME(field);                                                 \
    printf("[");                                                 \
    for (uint32_t k = 0; k < (length); ++k) {                    \
      if (k > 0) printf(", ");                                   \
      use;                                                       \
    }                                                            \
    printf("]");                                                 \
  } while (0)
#define NUMBERS(field) LIST(field, sample->field._length, number((double)sample->field._buffer[k]))
#define BIGS(field) LIST(field, sample->field._length, printf("%" PRIu64, (uint64_t)sample->field._buffer[k]))
#define TEXTS(field) LIST(field, sample->field._length, text(sample->field._buffer[k]))

static void print_ticks(const void* data) {
  const stilt_msgs_msg_dds__TickBatch_* sample = data;
  BIG(run_id);
  BIG(first_tick);
  BIG(count);
  NUMBERS(time_ns);
  NUMBERS(read_status);
  NUMBERS(joint_position_rad);
  NUMBERS(driver_fault_code);
  NUMBERS(estimated_state);
  NUMBERS(sent_torque_nm);
  NUMBERS(state);
  BIGS(latched_faults);
  NUMBERS(plan_sequence);
  NUMBERS(gait_speed_m_s);
  NUMBERS(bring_up_setting);
  NUMBERS(bring_up_reply_lag_s);
  NUMBERS(bring_up_version);
  NUMBERS(bring_up_wanted_version);
}

static void print_planner(const void* data) {
  const stilt_msgs_msg_dds__PlannerCycle_* sample = data;
  BIG(cycle);
  NUMBER(tick);
  NUMBER(time_s);
  NUMBER(status);
  NUMBER(iterations);
  NUMBER(cost);
  NUMBER(nodes);
  BIG(checksum);
  NUMBER(velocity_violation_max_rad_s);
}

static void print_plan(const void* data) {
  const stilt_msgs_msg_dds__Plan_* sample = data;
  NUMBER(plan_sequence);
  NUMBER(start_time_s);
  NUMBER(count);
  NUMBERS(contact);
  NUMBERS(base);
  NUMBERS(joint_torque_nm);
}

static void print_supervisor(const void* data) {
  const stilt_msgs_msg_dds__Supervisor_* sample = data;
  BIG(tick);
  NUMBER(time_s);
  NUMBER(state);
  NUMBER(request_speed_m_s);
  NUMBER(base_height_m);
  TEXT(commander);
  NUMBER(commander_alive);
  TEXT(state_name);
  TEXT(fallback_level_name);
  TEXTS(faults);
  TEXTS(found);
}

static void print_event(const void* data) {
  const stilt_msgs_msg_dds__Event_* sample = data;
  BIG(number);
  NUMBER(time_s);
  NUMBER(kind);
  TEXT(name);
  TEXT(text);
  NUMBER(joint);
  NUMBER(value);
  NUMBER(bus);
}

static void print_timing(const void* data) {
  const stilt_msgs_msg_dds__Timing_* sample = data;
  NUMBER(time_s);
  BIG(ticks);
  BIG(dropped_events);
  LIST(histograms, sample->histograms._length, text(sample->histograms._buffer[k].name));
}

static void print_configuration(const void* data) {
  const stilt_msgs_msg_dds__Configuration_* sample = data;
  BIG(run_id);
  TEXT(robot);
  TEXT(configuration);
  NUMBER(lockstep);
  NUMBER(torque_rate_hz);
  TEXT(token_file);
  LIST(tunables, sample->tunables._length, text(sample->tunables._buffer[k].key));
  NUMBER(wire_version);
}

static void print_tuning(const void* data) {
  const stilt_msgs_msg_dds__Tuning_* sample = data;
  NUMBER(number);
  TEXT(key);
  NUMBERS(values);
}

static void print_simulation(const void* data) {
  const stilt_msgs_msg_dds__Simulation_* sample = data;
  NUMBER(robot_time_s);
  NUMBER(push_n);
  LIST(contact_force_n, 4, number(sample->contact_force_n[k]));
}

/* A topic of stiltd. A stream is sent with best effort, so that a reader must ask for no more. */
typedef struct {
  const char* name;
  const dds_topic_descriptor_t* type;
  bool stream;
  void (*print)(const void* sample);
  dds_entity_t reader;
} Topic;

static Topic topics[] = {
    {"rt/stilt/ticks", &stilt_msgs_msg_dds__TickBatch__desc, false, print_ticks, 0},
    {"rt/stilt/planner", &stilt_msgs_msg_dds__PlannerCycle__desc, false, print_planner, 0},
    {"rt/stilt/plan", &stilt_msgs_msg_dds__Plan__desc, true, print_plan, 0},
    {"rt/stilt/supervisor", &stilt_msgs_msg_dds__Supervisor__desc, true, print_supervisor, 0},
    {"rt/stilt/event", &stilt_msgs_msg_dds__Event__desc, false, print_event, 0},
    {"rt/stilt/timing", &stilt_msgs_msg_dds__Timing__desc, true, print_timing, 0},
    {"rt/stilt/configuration", &stilt_msgs_msg_dds__Configuration__desc, false, print_configuration, 0},
    {"rt/stilt/tuning", &stilt_msgs_msg_dds__Tuning__desc, false, print_tuning, 0},
    {"rt/stilt/simulation", &stilt_msgs_msg_dds__Simulation__desc, true, print_simulation, 0},
};
enum { kTopics = sizeof topics / sizeof topics[0] };

static dds_entity_t checked(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "ros2_reader: %s: %s\n", what, dds_strretcode(entity));
    exit(2);
  }
  return entity;
}

static void open_reader(dds_entity_t participant, Topic* topic) {
  dds_qos_t* quality = dds_create_qos();
  dds_qset_reliability(quality, topic->stream ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  if (!topic->stream) dds_qset_durability(quality, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(quality, DDS_HISTORY_KEEP_ALL, 0);
  const dds_entity_t of = checked(dds_create_topic(participant, topic->type, topic->name, NULL, NULL), topic->name);
  topic->reader = checked(dds_create_reader(participant, of, quality, NULL), topic->name);
  dds_delete_qos(quality);
}

enum { kAtOnce = 64 };

static int take(dds_entity_t reader, const char* topic, void (*print)(const void* sample)) {
  void* samples[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  const int count = dds_take(reader, samples, infos, kAtOnce, kAtOnce);
  for (int k = 0; k < count; ++k) {
    if (!infos[k].valid_data) continue;
    printf("{\"topic\": \"%s\"", topic);
    print(samples[k]);
    printf("}\n");
  }
  if (count > 0) dds_return_loan(reader, samples, count);
  return count;
}

/* Who sends what, with the user data in which ROS 2 carries the hash of the type. */
static void print_publication(const void* data) {
  const dds_builtintopic_endpoint_t* sample = data;
  void* bytes = NULL;
  size_t size = 0;
  TEXT(topic_name);
  TEXT(type_name);
  NAME(user_data);
  if (dds_qget_userdata(sample->qos, &bytes, &size) && bytes != NULL) {
    text(bytes);
    dds_free(bytes);
  } else {
    text("");
  }
}

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "ros2_reader: usage: ros2_reader DOMAIN\n");
    return 2;
  }
  signal(SIGTERM, on_signal);
  const dds_domainid_t domain = (dds_domainid_t)strtoul(argv[1], NULL, 10);
  const dds_entity_t participant = checked(dds_create_participant(domain, NULL, NULL), "participant");
  const dds_entity_t publications =
      checked(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL), "publications");
  for (int k = 0; k < kTopics; ++k) open_reader(participant, &topics[k]);
  fprintf(stderr, "ready\n");
  bool more = true;
  while (!ends || more) {
    more = take(publications, "publication", print_publication) > 0;
    for (int k = 0; k < kTopics; ++k) more = take(topics[k].reader, topics[k].name, topics[k].print) > 0 || more;
    fflush(stdout);
    if (!more) dds_sleepfor(DDS_MSECS(1));
  }
  return checked(dds_delete(participant), "participant") == 0 ? 0 : 2;
}
