#include "host_tools/web/report/report.h"

#include <stdexcept>
#include <string_view>

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

}  // namespace

std::string render_report(const log::RunRecord& record) {
  const PageParts parts = split_template(kPageTemplate);
  std::string page;
  page += parts.head;
  page += escape_html("Stilt: run of " + record.robot.name);
  page += parts.middle;
  page += escape_script(run_data_json(record));
  page += parts.tail;
  return page;
}

}  // namespace stilt::report
