#compdef hertzline
# Completes the command lines of hertzline in zsh; the program knows the words.

_hertzline() {
    local -a answer plain open
    local line text program=${(Q)words[1]}
    answer=("${(@f)$("${program/#\~\//$HOME/}" completion zsh -- "${(@Q)words[2,CURRENT-1]}" "${(Q)PREFIX}" 2>/dev/null)}")
    for line in "${(@)answer[2,-1]}"; do
        text=${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}
        if [[ ${line%%$'\t'*} == *= ]]; then open+=("$text"); else plain+=("$text"); fi
    done
    (( $#plain )) && _describe -V word plain
    (( $#open )) && _describe -V word open -S ''
    case ${answer[1]} in
        files) _files ;;
        folders) _path_files -/ ;;
    esac
}

if [[ ${funcstack[1]} == _hertzline ]]; then
    _hertzline "$@"
else
    compdef _hertzline hertzline
fi
