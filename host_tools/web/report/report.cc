#include "host_tools/web/report/report.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "host_tools/web/report/comparison_page.h"
#include "host_tools/web/report/page_template.h"
#include "host_tools/web/report/run_data.h"

namespace stilt::report {
namespace {

std::string escape_html(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// Inside a script element only '<' can end the element or open a comment; in JSON it occurs only in strings.
std::string escape_script(std::string_view json) {
  std::string escaped;
  escaped.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

/// The parts of the page before, between and after its two marks.
struct PageParts {
  std::string_view head, middle, tail;
};

PageParts split_template(std::string_view page) {
  constexpr std::string_view kTitle = "{{title}}";
  constexpr std::string_view kRunData = "{{run_data}}";
  const auto title = page.find(kTitle);
  const auto data = page.find(kRunData);
  if (title == std::string_view::npos || data == std::string_view::npos || data < title) {
    throw std::logic_error("report.html must hold {{title}} and, after it, {{run_data}}");
  }
  const auto middle = title + kTitle.size();
  return {page.substr(0, title), page.substr(middle, data - middle), page.substr(data + kRunData.size())};
}

std::string render_page(const std::string& title, std::string_view data) {
  const PageParts parts = split_template(kPageTemplate);
  std::string page;
  page += parts.head;
  page += escape_html(title);
  page += parts.middle;
  page += escape_script(data);
  page += parts.tail;
  return page;
}

}  // namespace

std::string render_report(const log::RunRecord& record) {
  return render_page("Stilt: run of " + record.robot.name, run_data_json(record));
}

std::string data_of_page(std::string_view page) {
  constexpr std::string_view kBegin = R"(<script type="application/json" id="run-data">)";
  const auto begin = page.find(kBegin);
  const auto end = begin == std::string_view::npos ? begin : page.find("</script>", begin);
  if (end == std::string_view::npos) return "";
  return std::string(page.substr(begin + kBegin.size(), end - begin - kBegin.size()));
}

std::string render_comparison(const std::array<ComparedRun, 2>& runs, double shift_s) {
  const auto name = [](const ComparedRun& run) {
    return nlohmann::ordered_json(run.name).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  };
  const std::string data = R"({"names": [)" + name(runs[0]) + ", " + name(runs[1]) + R"(], "shift_s": )" +
                           nlohmann::ordered_json(shift_s).dump() + R"(, "runs": [)" + runs[0].data + ", " +
                           runs[1].data + "]}";
  return render_page("Stilt: " + runs[0].name + " and " + runs[1].name, data);
}

}  // namespace stilt::report
