# Doxygen's view of a header: its first comment describes the file, and the namespace, which each file would declare anew, is left out.
2i /// @file
2,/^$/s|^//|///|
/^namespace hertzline \{$/d
\|^\}  // namespace hertzline$|d
# Private members are left out.
/^ *private:$/,/^ *\};$/{
/^ *\};$/!d
}
# Sphinx cannot read lambdas.
/ = taps_where\(/{
:more
/\}\);$/!{
N
b more
}
s/ = taps_where.*/;/
}
