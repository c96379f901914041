#include "codegen/expression/emit.h"

#include <charconv>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

namespace stilt::codegen {
namespace {

std::string concat(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text += part;
  return text;
}

std::string numbered(std::string_view prefix, int id) { return concat({prefix, std::to_string(id)}); }

/// Writes the statements of one function.
class Emitter {
 public:
  Emitter(const FunctionSpec& spec, CoefficientTable* coefficients)
      : spec_(spec), coefficients_(coefficients) {}

  EmittedFunction run() {
    for (const Output& output : spec_.outputs) count_uses(output.value);
    for (const Output& output : spec_.outputs) {
      require(output.value);
      body_ << "  out." << output.path << " = " << root_text(output.value) << ";\n";
    }
    return {.text = header() + loads_.str() + body_.str() + "}\n", .count = count_};
  }

 private:
  static Expression child(Expression e, int id) { return {&e.graph(), id}; }
  static const Node& node_of(Expression e) { return e.graph().node(e.id()); }
  static bool is_trigonometric(const Node& n) {
    return n.operation == Operation::sine || n.operation == Operation::cosine;
  }

  /// Whether the emitted code reads `e` from the array of coefficients.
  bool is_loaded(Expression e) const {
    return coefficients_ != nullptr && e.graph().is_coefficient(e) && !e.graph().is_constant(e);
  }

  void count_uses(Expression e) {
    if (uses_[e.id()]++ > 0 || is_loaded(e)) return;
    const Node& n = node_of(e);
    if (n.left >= 0) count_uses(child(e, n.left));
    if (n.right >= 0) count_uses(child(e, n.right));
  }

  /// Whether `e` is written inside the statement that uses it: a product or negation used once.
  bool is_inlined(Expression e) const {
    const Node& n = node_of(e);
    return !is_loaded(e) && (n.operation == Operation::negate ||
                             (n.operation == Operation::multiply && uses_.at(e.id()) == 1));
  }

  /// Emits the statements that `e` needs before its text can stand in an expression.
  void require(Expression e) {
    const Node& n = node_of(e);
    if (n.operation == Operation::constant || is_loaded(e) || done_.contains(e.id())) return;
    if (n.left >= 0) require(child(e, n.left));
    if (n.right >= 0) require(child(e, n.right));
    done_.insert(e.id());
    count(n);
    if (n.operation == Operation::symbol) {
      loads_ << "  const T " << load_name(e) << " = " << n.name << ";\n";
    } else if (is_trigonometric(n)) {
      emit_sine_cosine(e);
    } else if (!is_inlined(e)) {
      body_ << "  const T t" << e.id() << " = " << expression_text(e) << ";\n";
    }
  }

  void emit_sine_cosine(Expression e) {
    const int angle = node_of(e).left;
    if (!angles_.insert(angle).second) return;
    ++count_.sine_cosine_pairs;
    const std::string a = std::to_string(angle);
    body_ << "  T s" << a << ";\n  T c" << a << ";\n  runtime::sincos(" << text(child(e, angle)) << ", s" << a
          << ", c" << a << ");\n";
  }

  void count(const Node& n) {
    switch (n.operation) {
      case Operation::add:
      case Operation::subtract:
        ++count_.additions;
        break;
      case Operation::multiply:
        ++count_.multiplications;
        break;
      case Operation::divide:
        ++count_.divisions;
        break;
      case Operation::negate:
        ++count_.negations;
        break;
      default:
        break;
    }
  }

  std::string load_name(Expression e) const {
    std::string name;
    for (const char c : node_of(e).name) {
      if (c == '[') name += '_';
      if (c != '[' && c != ']') name += c;
    }
    return name;
  }

  /// Text of `e` as an operand.
  std::string text(Expression e) const {
    if (is_loaded(e)) return concat({"k[", std::to_string(coefficients_->place(e)), "]"});
    const Node& n = node_of(e);
    switch (n.operation) {
      case Operation::constant:
        return n.value < 0.0 ? concat({"(", number_text(n.value), ")"}) : number_text(n.value);
      case Operation::symbol:
        return load_name(e);
      case Operation::sine:
        return numbered("s", n.left);
      case Operation::cosine:
        return numbered("c", n.left);
      case Operation::negate:
        return concat({"(-", text(child(e, n.left)), ")"});
      default:
        return is_inlined(e) ? concat({"(", expression_text(e), ")"}) : numbered("t", e.id());
    }
  }

  /// Text of `e` as a term of a sum: a product used once needs no parentheses.
  std::string term_text(Expression e) const {
    if (node_of(e).operation == Operation::multiply && is_inlined(e)) return expression_text(e);
    return text(e);
  }

  std::string expression_text(Expression e) const {
    const Node& n = node_of(e);
    const Expression l = child(e, n.left);
    const Expression r = child(e, n.right);
    switch (n.operation) {
      case Operation::add:
        return concat({term_text(l), " + ", term_text(r)});
      case Operation::subtract:
        return concat({term_text(l), " - ", term_text(r)});
      case Operation::multiply:
        return concat({text(l), " * ", text(r)});
      case Operation::divide:
        return concat({text(l), " / ", text(r)});
      case Operation::negate:
        return concat({"-", text(l)});
      default:
        return text(e);
    }
  }

  std::string root_text(Expression e) const {
    const Node& n = node_of(e);
    if (n.operation == Operation::constant) return concat({"T(", number_text(n.value), ")"});
    return is_inlined(e) ? expression_text(e) : text(e);
  }

  std::string header() const {
    std::ostringstream out;
    std::istringstream lines(spec_.documentation);
    for (std::string line; std::getline(lines, line);) out << "/// " << line << "\n";
    out << "///\n/// Operations: " << count_.total() << " (" << count_.additions << " additions, "
        << count_.multiplications << " multiplications, " << count_.divisions << " divisions, "
        << count_.negations << " negations) and " << count_.sine_cosine_pairs << " sine-cosine pairs.\n"
        << "template <class T, class Out>\ninline void " << spec_.name << "(";
    for (const std::string& parameter : spec_.parameters) out << "const T* " << parameter << ", ";
    out << "Out& out) noexcept {\n";
    return out.str();
  }

  const FunctionSpec& spec_;
  CoefficientTable* coefficients_;
  std::map<int, int> uses_;
  std::set<int> done_;
  std::set<int> angles_;
  std::ostringstream loads_;
  std::ostringstream body_;
  OperationCount count_;
};

}  // namespace

int CoefficientTable::place(Expression coefficient) {
  const auto [entry, inserted] = places_.try_emplace(coefficient.id(), static_cast<int>(entries_.size()));
  if (inserted) entries_.push_back(coefficient);
  return entry->second;
}

EmittedFunction emit_function(const FunctionSpec& spec, CoefficientTable* coefficients) {
  return Emitter(spec, coefficients).run();
}

std::string number_text(double value) {
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  std::string text(buffer, end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace stilt::codegen
