"""Enough of IEC 61131-3 Structured Text to check the export's grammar and to run it.

A grammar after the standard's annex for functions, function blocks, programs and a configuration
with global constants, and an interpreter over its tree. Block instances are called with named
inputs. As with compilers that keep to the standard's letter, a block sees a global constant only if
it declares it as external, of the same type.
"""

from __future__ import annotations

import itertools
import math
import operator

from lark import Lark, Token

GRAMMAR = r"""
    start: (function | block | program)+ configuration
    configuration: "CONFIGURATION" NAME globals resource "END_CONFIGURATION"
    globals: "VAR_GLOBAL" "CONSTANT" constant+ "END_VAR"
    constant: NAME ":" TYPE ":=" SIGN? (REAL | INTEGER) ";"
    resource: "RESOURCE" NAME "ON" NAME task task_program "END_RESOURCE"
    task: "TASK" NAME "(" "INTERVAL" ":=" TIME "," "PRIORITY" ":=" INTEGER ")" ";"
    task_program: "PROGRAM" NAME "WITH" NAME ":" NAME ";"
    program: "PROGRAM" NAME section* body "END_PROGRAM"
    function: FUNCTION NAME ":" TYPE section* body "END_FUNCTION"
    block: "FUNCTION_BLOCK" NAME section* body "END_FUNCTION_BLOCK"
    section: KIND variable+ "END_VAR"
    variable: NAME ":" (array | TYPE | NAME) ";"
    array: "ARRAY" "[" INTEGER ".." INTEGER ("," INTEGER ".." INTEGER)? "]" "OF" TYPE
    body: statement*
    ?statement: NAME ":=" expression ";" -> assign
        | NAME subscripts ":=" expression ";" -> assign_element
        | "FOR" NAME ":=" expression "TO" expression "DO" body "END_FOR" ";" -> repeat
        | IF expression THEN body (ELSE body)? "END_IF" ";" -> branch
        | NAME "(" binding ("," binding)* ")" ";" -> call_block
    subscripts: "[" expression ("," expression)? "]"
    binding: NAME ":=" expression
    ?expression: conjunction (OR conjunction)*
    ?conjunction: comparison (AND comparison)*
    ?comparison: sum (COMPARE sum)?
    ?sum: product (ADD product)*
    ?product: unary (MULTIPLY unary)*
    ?unary: NOT unary -> negate
        | SIGN unary -> minus
        | primary
    ?primary: (REAL | INTEGER) -> real
        | BOOLEAN -> boolean
        | "(" expression ")"
        | NAME "(" expression ("," expression)* ")" -> call
        | NAME "." NAME -> member
        | NAME subscripts -> element
        | NAME -> name
    FUNCTION.3: /FUNCTION\b/
    IF.3: /IF\b/
    THEN.3: /THEN\b/
    ELSE.3: /ELSE\b/
    OR.3: /OR\b/
    AND.3: /AND\b/
    NOT.3: /NOT\b/
    BOOLEAN.3: /TRUE\b/ | /FALSE\b/
    KIND.3: /VAR_INPUT\b/ | /VAR_OUTPUT\b/ | /VAR_EXTERNAL CONSTANT\b/ | /VAR\b/
    TYPE.3: /LREAL\b/ | /REAL\b/ | /BOOL\b/ | /DINT\b/ | /INT\b/
    TIME.3: /T#[0-9]+(\.[0-9]+)?ms/
    COMPARE: "<=" | ">=" | "<>" | "<" | ">" | "="
    ADD: "+" | "-"
    SIGN: "-"
    MULTIPLY: "*" | "/"
    NAME: /[A-Za-z_][A-Za-z0-9_]*/
    REAL.2: /[0-9]+\.[0-9]+(E[+-]?[0-9]+)?/
    INTEGER: /[0-9]+/
    COMMENT: /\(\*(.|\n)*?\*\)/
    %import common.WS
    %ignore WS
    %ignore COMMENT
"""
PARSER = Lark(GRAMMAR, parser="lalr")
_OPERATORS = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
    "=": operator.eq,
    "<>": operator.ne,
    "AND": lambda one, other: one and other,
    "OR": lambda one, other: one or other,
}
_LIBRARY = {"ABS": abs, "MIN": min, "MAX": max, "SQRT": math.sqrt}


class Program:
    """Constants, functions and function blocks of a text."""

    def __init__(self, text):
        tree = PARSER.parse(text)
        self.constants = {
            one.children[0].value: float("".join(one.children[2:]))
            for one in tree.find_data("constant")
        }
        self.kinds = {
            one.children[0].value: one.children[1].value for one in tree.find_data("constant")
        }
        self.interval = next(tree.find_data("task")).children[1].value
        self.functions = {one.children[1].value: one for one in tree.find_data("function")}
        self.blocks = {
            one.children[0].value: one
            for kind in ("block", "program")
            for one in tree.find_data(kind)
        }

    def instance(self, name):
        return Instance(self, self.blocks[name].children[1:])


def _zeros(array):
    """Return the elements of an array of numbers, by their places."""
    *bounds, kind = array.children
    assert kind in {"LREAL", "REAL"}
    pairs = zip(map(int, bounds[::2]), map(int, bounds[1::2]), strict=True)
    return dict.fromkeys(itertools.product(*(range(a, b + 1) for a, b in pairs)), 0.0)


class Instance:
    """A function block, or one call of a function, with its variables."""

    def __init__(self, program, parts):
        self.program, self.body, self.values = program, parts[-1], {}
        for section in parts[:-1]:
            for variable in section.children[1:]:
                name, kind = variable.children
                if not isinstance(kind, Token):
                    self.values[name.value] = _zeros(kind)
                elif section.children[0].startswith("VAR_EXTERNAL"):
                    assert kind == program.kinds[name.value], name
                    self.values[name.value] = program.constants[name.value]
                elif kind.type == "TYPE":
                    self.values[name.value] = False if kind == "BOOL" else 0.0
                else:
                    self.values[name.value] = program.instance(kind.value)

    def __getattr__(self, name):
        return self.values[name]

    def __call__(self, **inputs):
        assert inputs.keys() <= self.values.keys()
        self.values |= inputs
        self._run(self.body)

    def _run(self, body):
        for statement in body.children:
            getattr(self, f"_{statement.data}")(*statement.children)

    def _assign(self, name, expression):
        assert name.value in self.values.keys() - self.program.constants.keys(), name
        self.values[name.value] = self._value(expression)

    def _assign_element(self, name, subscripts, expression):
        place = self._places(subscripts)
        assert place in self.values[name.value], (name, place)  # within its bounds
        self.values[name.value][place] = self._value(expression)

    def _repeat(self, name, first, last, body):
        for count in range(int(self._value(first)), int(self._value(last)) + 1):
            self.values[name.value] = float(count)
            self._run(body)

    def _places(self, subscripts):
        return tuple(int(self._value(one)) for one in subscripts.children)

    def _branch(self, _if, condition, _then, body, _else=None, otherwise=None):
        if self._value(condition):
            self._run(body)
        elif otherwise is not None:
            self._run(otherwise)

    def _call_block(self, name, *bindings):
        inputs = {key.value: self._value(value) for key, value in (b.children for b in bindings)}
        self.values[name.value](**inputs)

    def _value(self, tree):
        own = getattr(Instance, f"_value_{tree.data}", None)
        return own(self, *tree.children) if own else self._folded(tree.children)

    def _value_real(self, digits):
        return float(digits)

    def _value_name(self, name):
        return self.values[name.value]

    def _value_boolean(self, word):
        return word == "TRUE"

    def _value_member(self, instance, name):
        return self.values[instance.value].values[name.value]

    def _value_element(self, name, subscripts):
        return self.values[name.value][self._places(subscripts)]

    def _value_call(self, name, *arguments):
        return self._called(name.value, [self._value(one) for one in arguments])

    def _value_negate(self, _not, operand):
        return not self._value(operand)

    def _value_minus(self, _sign, operand):
        return -self._value(operand)

    def _folded(self, parts):
        """Return a chain of operators, from the left."""
        result = self._value(parts[0])
        for sign, part in zip(parts[1::2], parts[2::2], strict=True):
            assert isinstance(sign, Token)
            result = _OPERATORS[sign.value](result, self._value(part))
        return result

    def _called(self, name, arguments):
        if name in _LIBRARY:
            return _LIBRARY[name](*arguments)
        parts = self.program.functions[name].children
        call = Instance(self.program, parts[3:])
        call.values[name] = 0.0
        inputs = [key for key in call.values if key != name]
        call(**dict(zip(inputs, arguments, strict=True)))
        return call.values[name]
