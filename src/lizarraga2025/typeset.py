"""LaTeX of printed formulas, with every term where the paper has it.

SymPy orders terms by rules of its own, and a reader could not compare the formula with the print.
So this module translates the plain text of `lizarraga2025.printed` term by term.
"""

import ast
from typing import Final

from lizarraga2025.printed import label

INVERSE: Final = {"acos": "cos", "asin": "sin"}


def latex(formula: str) -> str:
    r"""Write a formula of `lizarraga2025.printed` in LaTeX, in the order of its terms.

    Examples
    --------
    >>> print(latex("pi - q1 - acos((z_1_2 - x_min_1)/x_2_3)"))
    \pi - q_1 - \cos^{-1}\left(\frac{z_{1,2} - x_{\min,1}}{x_{2,3}}\right)
    """
    return _latex(ast.parse(formula, mode="eval").body)


def _latex(node: ast.expr) -> str:
    match node:
        case ast.Name(id="pi"):
            return r"\pi"
        case ast.Name(id=name):
            return label(name).replace("{min", r"{\min")
        case ast.Constant(value=value):
            return str(value)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return f"-{_factor(operand)}"
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return rf"\frac{{{_latex(left)}}}{{{_latex(right)}}}"
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return f"{_factor(left)}^{{{_latex(right)}}}"
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return f"{_factor(left)} {_factor(right)}"
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return f"{_latex(left)} + {_latex(right)}"
        case ast.BinOp(left=left, op=ast.Sub(), right=right):
            return f"{_latex(left)} - {_factor(right)}"
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, [_latex(argument) for argument in arguments])
    raise ValueError(f"no part of a printed formula: {ast.unparse(node)}")


def _factor(node: ast.expr) -> str:
    """Write a factor: a sum stands in brackets."""
    is_sum = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)
    return rf"\left({_latex(node)}\right)" if is_sum else _latex(node)


def _call(name: str, arguments: list[str]) -> str:
    if name == "sqrt":
        return rf"\sqrt{{{arguments[0]}}}"
    if name == "arctan":
        return rf"\tan^{{-1}}\left(\frac{{{arguments[0]}}}{{{arguments[1]}}}\right)"
    if name in INVERSE:
        return rf"\{INVERSE[name]}^{{-1}}\left({arguments[0]}\right)"
    return rf"\{name}({arguments[0]})"
