#include "host_tools/recording/csv/record_to_csv.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>

#include "firmware/diagnostics/tick_csv.h"
#include "firmware/telemetry/cdr.h"
#include "firmware/telemetry/tick_batch.h"
#include "firmware/telemetry/topics.h"
#include "host_tools/recording/csv/csv_table.h"
#include "host_tools/recording/csv/table_file.h"
#include "host_tools/recording/mcap/reader.h"
#include "host_tools/recording/record/record_version.h"
#include "host_tools/recording/record/recorder.h"
#include "host_tools/recording/record/tick_ledger.h"
#include "host_tools/recording/schema/decode.h"

namespace stilt::csv {
namespace {

using Json = nlohmann::ordered_json;

/// Times of tick 0 by the number of the run, ns, where the record has its configuration.
using Starts = std::map<std::uint64_t, std::int64_t>;

Starts starts_of(const std::string& record) {
  Starts starts;
  mcap::Reader reader(record);
  while (const mcap::ReadMessage* read = reader.next()) {
    if (record::topic_of_record(read->channel->topic) != &telemetry::kConfiguration) continue;
    const auto message = telemetry::decode<telemetry::ActiveConfiguration>(std::as_bytes(read->message.data));
    if (message) starts[message->run_id] = message->start_clock_ns;
  }
  return starts;
}

/// Tables of ticks: all runs in one file, or one file per run.
class TickTables {
 public:
  TickTables(std::string first_path, bool one_each, Starts starts)
      : first_path_(std::move(first_path)), one_each_(one_each), starts_(std::move(starts)) {}

  void add(const telemetry::TickBatch& batch) {
    if (!telemetry::well_formed(batch)) return;
    auto [run, is_new] = runs_.try_emplace(batch.run_id);
    if (is_new) open(run->second);
    record::TickLedger& ticks = run->second.ticks;
    for (std::size_t i = 0; i < batch.count; ++i) {
      const control_loop::TickRecord tick = telemetry::tick_record(batch, i);
      if (tick.tick < ticks.next()) continue;
      ticks.add(tick.tick, 1);
      const std::int64_t start_ns = starts_.try_emplace(batch.run_id, tick.time_ns).first->second;
      diagnostics::write_tick(run->second.file->text(), tick, start_ns);
    }
  }

  void close() {
    for (const auto& file : files_) file->close();
  }

  /// Gives the closed files their names.
  void place(const std::string& record, Written& written) {
    for (const auto& file : files_) file->place();
    written.files.insert(written.files.end(), paths_.begin(), paths_.end());
    for (const Run* run : in_order_) {
      if (!run->ticks.has_break()) continue;
      const std::string table = std::filesystem::path(run->path).filename().string();
      written.problems.push_back(std::string(record)
                                     .append(": ")
                                     .append(run->ticks.text_of_breaks())
                                     .append("; no rows for them in ") +
                                 table);
    }
  }

 private:
  struct Run {
    TableFile* file = nullptr;
    std::string path;  ///< of the file
    record::TickLedger ticks;
  };

  void open(Run& run) {
    if (files_.empty() || one_each_) {
      std::filesystem::path path = first_path_;
      if (!files_.empty()) path.replace_filename("ticks_" + std::to_string(files_.size() + 1) + ".csv");
      paths_.push_back(path.string());
      files_.push_back(std::make_unique<TableFile>(path.string()));
      diagnostics::write_tick_header(files_.back()->text());
    }
    run.file = files_.back().get();
    run.path = paths_.back();
    in_order_.push_back(&run);
  }

  std::string first_path_;
  bool one_each_;
  Starts starts_;  ///< of a run without configuration: its first tick here
  std::map<std::uint64_t, Run> runs_;
  std::vector<const Run*> in_order_;
  std::vector<std::unique_ptr<TableFile>> files_;
  std::vector<std::string> paths_;
};

bool is_ticks(const mcap::ReadMessage& read) {
  return record::topic_of_record(read.channel->topic) == &telemetry::kTicks;
}

void add_ticks(const mcap::ReadMessage& read, TickTables& ticks) {
  const auto batch = telemetry::decode<telemetry::TickBatch>(std::as_bytes(read.message.data));
  if (batch) ticks.add(*batch);
}

std::string file_name(std::string topic) {
  topic.erase(0, topic.find_first_not_of('/'));
  std::ranges::replace(topic, '/', '_');
  return topic + ".csv";
}

/// Tables of all other topics.
class TopicTables {
 public:
  explicit TopicTables(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const mcap::ReadMessage& read) {
    Json row = {{"log_time_ns", read.message.log_time_ns}};
    try {
      row.update(decoded(read));
    } catch (const std::runtime_error& error) {
      defects_.try_emplace(read.channel->topic, error.what());
      return;
    }
    auto& table = tables_[read.channel->topic];
    if (!table) {
      paths_.push_back((folder_ / file_name(read.channel->topic)).string());
      table = std::make_unique<Table>(paths_.back());
    }
    table->add(row);
  }

  void close() {
    for (const auto& [topic, table] : tables_) table->close();
  }

  /// Gives the closed tables their names.
  void place(const std::string& record, Written& written) {
    for (const auto& [topic, table] : tables_) table->place();
    written.files.insert(written.files.end(), paths_.begin(), paths_.end());
    for (const auto& [topic, defect] : defects_) {
      const char* left_out = tables_.contains(topic) ? "; such messages are left out" : "; it is left out";
      written.problems.push_back(
          std::string(record).append(": topic ").append(topic).append(": ").append(defect).append(left_out));
    }
  }

 private:
  /// Throws std::runtime_error, with what is wrong, when the message cannot be decoded.
  Json decoded(const mcap::ReadMessage& read) {
    if (read.schema == nullptr) throw std::runtime_error("the type of its messages is not defined");
    if (read.schema->encoding != "ros2msg" || read.channel->message_encoding != "cdr") {
      throw std::runtime_error("its messages are " + read.channel->message_encoding + " defined by " +
                               read.schema->encoding + ", where cdr defined by ros2msg can be read");
    }
    const std::string& type = read.schema->name;
    if (!types_.contains(type)) types_[type] = schema::parse_ros2msg(read.schema->text, type);
    return schema::decode(types_.at(type), type, read.message.data);
  }

  std::filesystem::path folder_;
  std::map<std::string, schema::MessageTypes> types_;
  std::map<std::string, std::unique_ptr<Table>> tables_;
  std::map<std::string, std::string> defects_;  ///< the first of each topic
  std::vector<std::string> paths_;
};

/// Tables of another record among those of this one would pass for its own.
void refuse_tables(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    throw std::runtime_error(folder + ": has tables already, such as " + entry.path().filename().string() +
                             "; name another folder or remove them");
  }
}

}  // namespace

Written record_to_csv(const std::string& record, const std::string& folder) {
  record::require_wire_version(record);
  mcap::Reader reader(record);
  refuse_tables(folder);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder + ": cannot be made; name a folder where one may be");
  }
  TickTables ticks((std::filesystem::path(folder) / "ticks.csv").string(), true, starts_of(record));
  TopicTables topics(folder);
  while (const mcap::ReadMessage* read = reader.next()) {
    if (is_ticks(*read)) {
      add_ticks(*read, ticks);
    } else {
      topics.add(*read);
    }
  }
  Written written{{}, reader.problems()};
  ticks.close();
  topics.close();  // all are whole before the first has its name
  ticks.place(record, written);
  topics.place(record, written);
  return written;
}

Written ticks_to_csv(const std::string& record, const std::string& file) {
  record::require_wire_version(record);
  mcap::Reader reader(record);
  TickTables ticks(file, false, starts_of(record));
  while (const mcap::ReadMessage* read = reader.next()) {
    if (is_ticks(*read)) add_ticks(*read, ticks);
  }
  Written written{{}, reader.problems()};
  ticks.close();
  ticks.place(record, written);
  if (written.files.empty()) {
    throw std::runtime_error(record::without_ticks(record, written.problems));
  }
  return written;
}

}  // namespace stilt::csv
