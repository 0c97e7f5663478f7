# Completes the command lines of hertzline in bash 4.4 and later; the program knows the words.

_hertzline() {
    local line=${COMP_LINE:0:COMP_POINT} words=() i
    # bash splits words at the = and : of $COMP_WORDBREAKS; those without a blank between them are one word
    line=${line#*"${COMP_WORDS[0]}"}
    for ((i = 1; i <= COMP_CWORD; ++i)); do
        local part=${COMP_WORDS[i]}
        if [[ $line == [[:space:]]* || i -eq 1 ]]; then
            line=${line#"${line%%[![:space:]]*}"}
            words+=('')
        fi
        ((i == COMP_CWORD)) && part=$line
        words[-1]+=$part
        line=${line#"$part"}
    done
    local typed=${words[-1]} quoted=
    [[ $typed == [\"\']* ]] && quoted=yes
    typed=${typed#[\"\']}
    words[-1]=$typed

    local program=${1//[\\\"\']/}  # as typed, with the quotes and backslashes of its blanks
    local answer paths
    mapfile -t answer < <("${program/#\~\//$HOME/}" completion bash -- "${words[@]}" 2>/dev/null)
    paths=${answer[0]:-none}
    COMPREPLY=("${answer[@]:1}")
    COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
    if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]]; then
        compopt -o nospace
    fi

    # readline replaces a word in quotes, and of others what follows the last = or :
    local last=${typed##*[=:]}
    [[ -z $quoted && $COMP_WORDBREAKS == *=* && $COMP_WORDBREAKS == *:* ]] || last=$typed
    COMPREPLY=("${COMPREPLY[@]#"${typed%"$last"}"}")

    case $paths in
    none) compopt +o default +o bashdefault ;;
    files | folders)
        # where nothing else fits, readline completes names itself, with their quotes
        if [[ $paths == folders || ${#COMPREPLY[@]} -gt 0 ]]; then
            compopt -o filenames
            local kind=-f
            [[ $paths == folders ]] && kind=-d && compopt +o default +o bashdefault
            mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen "$kind" -- "$last")
        fi
        ;;
    esac
}

complete -o default -F _hertzline hertzline
