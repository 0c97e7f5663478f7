# Completes the command lines of hertzline in fish; the program knows the words.

function __hertzline_words
    set -l before (commandline -opc)
    set -l typed (commandline -ct)
    set -l answer ($before[1] completion fish -- $before[2..-1] "$typed" 2>/dev/null)
    switch "$answer[1]"
        case files
            __fish_complete_path "$typed"
        case folders
            __fish_complete_directories "$typed" ""
    end
    printf '%s\n' $answer[2..-1]
end

complete -c hertzline -f -k -a '(__hertzline_words)'
